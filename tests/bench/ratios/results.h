// What a section measured: tables on stdout as they come, and all of them as JSON at the end.
#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace innermap::bench {

using Json = nlohmann::ordered_json;

// Seconds since it was made or since the last lap.
class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> elapsed = now - start_;
    start_ = now;
    return elapsed.count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::string digits(double value);  // three of them

// A table whose rows are objects; the keys of the first row are the columns.
class Table {
 public:
  explicit Table(std::string title);

  // Prints the row (the heading before the first) and keeps it. Numbers to three digits.
  void add(const Json& row);

  // A line below the table: what was compared, how, with which limits.
  void note(const std::string& text);

  Json json() const;

 private:
  std::string title_;
  std::vector<std::string> columns_;
  std::vector<std::size_t> widths_;
  Json rows_ = Json::array(), notes_ = Json::array();
};

// Processor, cores, instruction sets of the kernel sums and of BLAS.
Json machine();

}  // namespace innermap::bench
