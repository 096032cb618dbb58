// The framework of innermap's subcommands.
//
// To add one, write NAME.cc here after the shortest there is, evaluate.cc, and list its
// make function in commands.h and commands.cc. --help, docs/commands.md, did-you-mean, range checks
// and the common options (--threads, --max-memory, --dry-run, --report, --quiet, --help) come by
// themselves. Throw innermap's errors; they become one line on stderr and exit code 1 (UsageError:
// 2, Cancelled: 130). The run that main.cc enters has the progress and the limits.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "context.h"
#include "innermap/core/error.h"
#include "option.h"

namespace innermap::tool {

// What the user typed makes no sense: exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

// Cancelled when some of the results are in place and stay there; `what` says which.
class CancelledLate : public Cancelled {
 public:
  explicit CancelledLate(std::string what) : what_(std::move(what)) {}
  const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

class Command {
 public:
  Command(std::string name, std::string summary)
      : name_(std::move(name)), summary_(std::move(summary)) {}
  Command(Command&&) = default;
  Command& operator=(Command&&) = default;

  // Arguments without a name, in order; required unless .optional(). The last may be a list.
  OptionBuilder positional(const std::string& name, Target target, const std::string& help);
  OptionBuilder option(const std::string& name, const std::string& placeholder, Target target,
                       const std::string& help);
  // One of the values by its name; the default is what *target is.
  template <class Value>
  OptionBuilder choice(const std::string& name, const std::string& placeholder, Value* target,
                       const std::vector<std::pair<std::string, Value>>& values,
                       const std::string& help) {
    return option(name, placeholder, choiceOf(target, values), help);
  }
  OptionBuilder flag(const std::string& name, bool* target, const std::string& help);
  // -o, --output: a file with one of these endings; a folder. Both required.
  OptionBuilder outputFile(std::string* path, std::vector<std::string> endings,
                           const std::string& help);
  OptionBuilder outputFolder(std::string* path,
                             const std::string& help = "folder for the files; made if missing");
  // An option for each setting of the library: max_charges is --max-charges; a flag that is on is
  // turned off by --no-NAME.
  void settings(const std::vector<Setting>& described);
  OptionBuilder setting(const Setting& described);
  // The title in the help of the options that follow; "": plain "options".
  void group(const std::string& title) { group_ = title; }

  void description(std::string text) { description_ = std::move(text); }  // beyond the summary
  void example(std::string line) { examples_.push_back(std::move(line)); }
  // Adds --max-time S; help: what ends by it. See Context::spend.
  OptionBuilder limitTime(const std::string& help);
  // Seconds; infinity: no limit.
  double maxTime() const { return maxTime_->value_or(std::numeric_limits<double>::infinity()); }
  // Adds --up, --unit-scale, --out-up, --out-unit-scale, for Context::space().
  void addSpace();
  const SpaceSettings& space() const { return *space_; }
  void run(std::function<void(Context&)> body) { body_ = std::move(body); }
  // The last: this command, which calls `body` with its options.
  template <class Options>
  Command running(std::shared_ptr<Options> options, void (*body)(const Options&, Context&)) {
    run([options = std::move(options), body](Context& context) { body(*options, context); });
    return std::move(*this);
  }

  const std::string& name() const { return name_; }
  const std::string& summary() const { return summary_; }
  const std::string& description() const { return description_; }
  const std::vector<Option>& options() const { return options_; }
  const std::vector<std::string>& examples() const { return examples_; }
  void execute(Context& context) const { body_(context); }

 private:
  std::string name_, summary_, description_, group_;
  std::vector<Option> options_;
  std::vector<std::string> examples_;
  std::function<void(Context&)> body_;
  std::unique_ptr<std::optional<double>> maxTime_ = std::make_unique<std::optional<double>>();
  std::unique_ptr<SpaceSettings> space_ = std::make_unique<SpaceSettings>();
};

// "max_charges": "--max-charges".
std::string optionName(const std::string& setting);

// The options that every command has, bound to `common`.
std::vector<Option> commonOptionTable(CommonOptions& common);
// The command's own, and those that it has no own option in place of.
std::vector<Option> allOptions(const Command& command, CommonOptions& common);

// Parses `arguments` (after the command's name) by the command's table and the common one. Throws
// UsageError, SettingError. Sets `common.help` and checks nothing further when --help is there;
// likewise with --help-all and --version.
void parseArguments(const Command& command, CommonOptions& common,
                    const std::vector<std::string>& arguments);

// "; did you mean x?" for the nearest of `known`, or "".
std::string didYouMean(const std::string& typed, const std::vector<std::string>& known);

}  // namespace innermap::tool
