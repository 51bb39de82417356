// sweep.json: what is written is read back; how the state of a run follows from its directory.
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.hpp"
#include "io/durable.hpp"
#include "io/lock.hpp"
#include "io/sweep_record.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

TEST_CASE("sweep record: written and read back, in the agreed format", "[sweep]") {
  const ScratchFolder folder;
  CHECK_FALSE(read_sweep_record(folder / ""));
  SweepRecord record{"/scenes/base.toml", {}};
  record.runs.push_back({"Ca0.1", {{"flow.capillary_number", "0.1"}, {"accuracy.vertex_update", "\"euler\""}, {"box.size", "[8, 8.5, 10]"}}, RunState::finished, 0, ""});
  record.runs.push_back({"Ca0.2", {{"output.fluid", "true"}}, RunState::failed, 3, "a \"guard\""});
  record.runs.push_back({"Ca0.3", {}, RunState::waiting, {}, ""});
  write_sweep_record(folder / "", record);
  CHECK_FALSE(std::filesystem::exists(folder / "sweep.json.tmp"));

  std::ifstream file(folder / "sweep.json");
  const auto json = nlohmann::json::parse(file);
  CHECK(json["format"] == "corpuscle-sweep-1");
  CHECK(json["scene"] == "/scenes/base.toml");
  CHECK(json["runs"][0]["directory"] == "Ca0.1");
  CHECK(json["runs"][0]["overrides"]["flow.capillary_number"] == 0.1);
  CHECK(json["runs"][0]["overrides"]["accuracy.vertex_update"] == "euler");
  CHECK(json["runs"][0]["overrides"]["box.size"] == nlohmann::json{8, 8.5, 10});
  CHECK(json["runs"][1]["exit_code"] == 3);
  CHECK(json["runs"][2]["exit_code"].is_null());

  const auto again = read_sweep_record(folder / "");
  REQUIRE(again);
  REQUIRE(again->runs.size() == 3);
  CHECK(again->scene == record.scene);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(again->runs[i].name == record.runs[i].name);
    CHECK(again->runs[i].state == record.runs[i].state);
    CHECK(again->runs[i].exit_code == record.runs[i].exit_code);
    CHECK(again->runs[i].message == record.runs[i].message);
  }
  CHECK(again->runs[0].overrides[1] == record.runs[0].overrides[1]);
}

TEST_CASE("sweep record: another file is refused", "[sweep]") {
  const ScratchFolder folder;
  for (const char* text : {"", "{", "{}", "[]", R"({"format": "other", "runs": []})", R"({"format": "corpuscle-sweep-1", "scene": "a", "runs": [{"name": 3}]})",
                           R"({"format": "corpuscle-sweep-1", "scene": "a", "runs": [{"name": "a", "overrides": {}, "state": "asleep", "exit_code": null, "message": ""}]})"}) {
    INFO(text);
    std::ofstream(folder / "sweep.json") << text;
    CHECK(complaint_lacks([&] { read_sweep_record(folder / ""); }, {"sweep.json", "remove it"}) == "");
  }
}

TEST_CASE("sweep record: the state of a run is that of its directory", "[sweep]") {
  const ScratchFolder folder;
  const auto run = folder / "run";
  const auto state_of = [&](RunState recorded, std::optional<int> code = {}) {
    SweepRun r{"run", {}, recorded, code, ""};
    update(r, look_at_run(run), 100);
    return r.state;
  };
  const auto ended = [&](const char* by, int steps) { std::ofstream(run / "summary.json") << nlohmann::json{{"stopped_by", by}, {"steps", steps}}; };
  CHECK(state_of(RunState::waiting) == RunState::waiting);
  CHECK(state_of(RunState::finished, 0) == RunState::waiting);  // its directory was removed
  CHECK(state_of(RunState::running) == RunState::stopped);      // killed while it packed
  std::filesystem::create_directory(run);
  std::ofstream(run / "checkpoint-b.h5") << "x";
  CHECK(state_of(RunState::waiting) == RunState::stopped);
  CHECK(state_of(RunState::running) == RunState::stopped);
  CHECK(state_of(RunState::failed, 1) == RunState::failed);  // known better than what the directory tells
  ended("interrupt", 50);
  CHECK(state_of(RunState::running) == RunState::stopped);
  ended("end", 50);  // of a shorter run that is being made longer
  CHECK(state_of(RunState::running) == RunState::stopped);
  ended("end", 100);
  CHECK(state_of(RunState::running) == RunState::finished);
  CHECK(state_of(RunState::failed, 1) == RunState::finished);
  ended("guard", 50);
  CHECK(state_of(RunState::running) == RunState::failed);
  {
    const DirectoryLock lock(run);
    CHECK(state_of(RunState::stopped) == RunState::running);
  }
  std::ofstream(run / "summary.json") << "no json";
  CHECK(state_of(RunState::running) == RunState::stopped);
}

TEST_CASE("sweep record: a file is replaced as a whole, or stays", "[sweep]") {
  const ScratchFolder folder;
  const auto path = folder / "file";
  const auto text = [&] {
    std::ostringstream all;
    all << std::ifstream(path).rdbuf();
    return all.str();
  };
  replace_file(path, "one", "the test");
  replace_file(path, "two", "the test");
  CHECK(text() == "two");
  std::filesystem::create_directory(folder / "file.tmp");  // so that the temporary file can't be made
  try {
    replace_file(path, "three", "the test");
    FAIL("no OutputError");
  } catch (const OutputError& error) {
    CHECK(std::string(error.what()).find("file: writing the test failed: ") != std::string::npos);
  }
  CHECK(text() == "two");
}
