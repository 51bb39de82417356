// One run per directory: the lock is refused to a second one, and gone with its holder.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "io/lock.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

TEST_CASE("lock: a directory is locked once, and free again afterwards", "[io]") {
  const ScratchFolder folder;
  const std::string process = "process " + std::to_string(::getpid());
  CHECK(lock_holder(folder / "") == "");
  {
    const DirectoryLock lock(folder / "");
    CHECK(lock_holder(folder / "").find(process) == 0);
    CHECK(complaint_lacks([&] { DirectoryLock second(folder / ""); }, {"--output", process.c_str(), "choose another"}) == "");
    CHECK(complaint_lacks([&] { require_unlocked(folder / ""); }, {process.c_str()}) == "");
  }
  CHECK_FALSE(std::filesystem::exists(folder / "lock"));
  CHECK_NOTHROW(DirectoryLock(folder / ""));
}

TEST_CASE("lock: a killed process leaves none behind", "[io]") {
  const ScratchFolder folder;
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const DirectoryLock lock(folder / "");
    (void)!::write(ready[1], "x", 1);
    for (;;) ::pause();
  }
  char byte;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  CHECK(lock_holder(folder / "").find("process " + std::to_string(child)) == 0);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK(std::filesystem::exists(folder / "lock"));  // the file stays, the lock doesn't
  CHECK(lock_holder(folder / "") == "");
  CHECK_NOTHROW(DirectoryLock(folder / ""));
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_CASE("lock: a directory that isn't there", "[io]") {
  const ScratchFolder folder;
  CHECK(lock_holder(folder / "none") == "");
  CHECK_THROWS(DirectoryLock(folder / "none"));
}
