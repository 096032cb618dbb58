#include "run_record.h"

#include <cctype>
#include <chrono>
#include <ctime>
#include <limits>
#include <thread>

#include "innermap/core/version.h"

namespace innermap::tool {
namespace {

// The value of a choice is what was given, or its default.
struct ValueOf {
  const Option& option;
  const CommonOptions& common;
  ReportValue operator()(const bool* v) const { return *v == option.sets; }
  ReportValue operator()(const int* v) const { return std::int64_t(*v); }
  ReportValue operator()(const std::uint64_t* v) const { return static_cast<std::int64_t>(*v); }
  ReportValue operator()(const double* v) const { return *v; }
  ReportValue operator()(const std::string* v) const {
    if (v->empty()) return leftToTheCommand();
    return *v;
  }
  ReportValue operator()(const std::vector<std::string>* v) const { return *v; }
  ReportValue operator()(const SettingChoice&) const {
    const auto given = common.given.find(option.name);
    const std::string& text = given == common.given.end() ? option.defaultText : given->second;
    if (text.empty()) return leftToTheCommand();
    return text;
  }
  ReportValue operator()(const Cut* v) const {
    if (!v->axis && !v->at) return leftToTheCommand();
    return textOf(*v);
  }
  ReportValue operator()(const std::optional<NumberPair>* v) const {
    if (!*v) return leftToTheCommand();
    return std::vector<double>{(*v)->first, (*v)->second};
  }
  template <class Value>
  ReportValue operator()(const std::optional<Value>* v) const {
    if (!*v) return leftToTheCommand();
    return (*this)(&**v);
  }

 private:
  static ReportValue leftToTheCommand() { return std::numeric_limits<double>::quiet_NaN(); }
};

std::string now() {
  const std::time_t seconds =
      std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

std::string settingKey(const std::string& option) {
  std::string key;
  for (const char c : option.substr(option.find_first_not_of('-')))
    key += c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return key;
}

void recordRun(const Command& command, const CommonOptions& common, Report& report) {
  report.command = command.name();
  ReportRun run;
  run.version = versionText();
  run.commandLine = {"innermap", command.name()};
  run.commandLine.insert(run.commandLine.end(), common.arguments.begin(), common.arguments.end());
  run.date = now();
  run.cores = static_cast<int>(std::thread::hardware_concurrency());
  run.threads = common.threads > 0 ? common.threads : run.cores;
  for (const Option& option : command.options())
    run.settings.emplace_back(settingKey(option.name),
                              std::visit(ValueOf{option, common}, option.target));
  run.settings.emplace_back(settingKey("--cpu-target"),
                            ValueOf{Option(), common}(&common.cpuTarget));
  report.run = std::move(run);
}

}  // namespace innermap::tool
