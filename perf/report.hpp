// What a benchmark measured: rows that are printed as they come and written as one JSON section (docs/performance.md says who reads it).
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace corpuscle::perf {

using Json = nlohmann::ordered_json;

/// How much time a benchmark may take.
struct Effort {
  bool quick = false;         ///< tiny sizes, one repeat: shows that it runs, says nothing about speed
  int repeats = 4;            ///< the best of so many
  double min_seconds = 0.08;  ///< each at least so long
};

/// A measured quantity that perf/compare.py judges.
struct Metric {
  std::string name;    ///< key in the rows; the unit is its last part: "spread_ms", "interpolate_M_s"
  std::string better;  ///< "higher" or "lower"
};

/// One section of a result file. Rows are matched between files by their "case".
class Section {
 public:
  /// Reads the arguments of a benchmark: [--quick] [--output FILE]. Prints usage and exits on others.
  Section(int argc, char** argv, std::string name, std::string about, std::vector<Metric> metrics);

  const Effort& effort() const { return effort_; }
  /// Adds a row and prints it to the standard error. `values` are settings and measurements in the order of the table.
  void row(const std::string& name, const Json& values);
  /// A statement about the whole section: sizes, what was left out.
  void note(const std::string& text) { notes_.push_back(text); }
  /// Writes the section with compiler, flags, revision, Kokkos and threads: to the file, else to the standard output. Returns the exit code.
  int finish();

 private:
  std::string name_, about_, output_;
  std::vector<Metric> metrics_;
  Effort effort_;
  Json rows_ = Json::array(), notes_ = Json::array();
};

/// Compiler, flags, revision, Kokkos, threads of this program.
Json build_description();

/// Bytes of memory that the system could still give, from /proc/meminfo; 0 where it doesn't say.
double available_bytes();

/// x to four significant digits: results carry no more.
double rounded(double x);

}  // namespace corpuscle::perf
