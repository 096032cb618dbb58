#include "results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <thread>

#include "innermap/solve/kernel_sum.h"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" char* openblas_get_corename();

namespace innermap::bench {
namespace {

std::string cell(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return digits(value.get<double>());
  return value.is_null() ? "" : value.dump();
}

}  // namespace

std::string digits(double value) { return fmt::format("{:.3g}", value); }

Table::Table(std::string title) : title_(std::move(title)) {
  fmt::print("\n{}\n", title_);
  std::fflush(stdout);
}

void Table::add(const Json& row) {
  constexpr std::size_t kNarrowest = 8, kFirst = 26;
  if (columns_.empty()) {
    for (const auto& [key, value] : row.items()) {
      columns_.push_back(key);
      widths_.push_back(std::max({kNarrowest, key.size(), cell(value).size(),
                                  widths_.empty() && value.is_string() ? kFirst : 0}) +
                        2);
      fmt::print("{:<{}}", key, widths_.back());
    }
    fmt::print("\n");
  }
  for (std::size_t c = 0; c < columns_.size(); ++c)
    fmt::print("{:<{}} ", row.contains(columns_[c]) ? cell(row[columns_[c]]) : "", widths_[c] - 1);
  fmt::print("\n");
  std::fflush(stdout);
  rows_.push_back(row);
}

void Table::note(const std::string& text) {
  fmt::print("  {}\n", text);
  std::fflush(stdout);
  notes_.push_back(text);
}

Json Table::json() const { return {{"title", title_}, {"rows", rows_}, {"notes", notes_}}; }

Json machine() {
  std::string model = "unknown";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    model = line.substr(std::min(line.size(), line.find(':') + 2));
    break;
  }
  return {{"processor", model},
          {"cores", std::thread::hardware_concurrency()},
          {"kernel_sums", instructionSet()},
          {"blas", openblas_get_corename()}};
}

}  // namespace innermap::bench
