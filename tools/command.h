// The framework of innermap's subcommands.
//
// How to add a command, say `fit`:
//
//  1. Write tools/fit.cc:
//
//       #include "commands.h"
//
//       namespace innermap::tool {
//       namespace {
//       struct FitOptions {              // defaults live here (or in the library's settings)
//         std::string source, target, output;
//         std::size_t sources = 2000;
//         std::optional<double> distance;
//       };
//
//       void run(const FitOptions& options, Context& context) {
//         context.output(options.output);        // refuses early what cannot be written
//         Mesh mesh;
//         context.timed("read", [&] { mesh = readMesh(options.source, {context.progress()}); });
//         const std::uint64_t need = ...;
//         if (context.dryRun()) return context.plan({"fit ... to " + options.output}, need);
//         requireMemory("the fit", need, context.maxMemory(), "lower --sources to ...");
//         ...
//         context.report().solve = ...;             // --report F is written by the framework
//       }
//       }  // namespace
//
//       Command makeFitCommand() {
//         auto o = std::make_shared<FitOptions>();
//         Command c("fit", "Fit a harmonic map to two meshes and save it");
//         c.positional("SOURCE", &o->source, "the solid's mesh");
//         c.option("--output", "FILE", &o->output, "the map's file").shortName("-o").required();
//         c.option("--sources", "N", &o->sources, "number of charges").range(1, 1e7);
//         c.option("--distance", "D", &o->distance, "of the charges from the surface")
//             .unit("fraction of the diagonal").above(0).atMost(2).defaults("chosen by error");
//         c.example("innermap fit rest.obj pose.obj -o map.ply");
//         c.run([o](Context& context) { run(*o, context); });
//         return c;
//       }
//       }  // namespace innermap::tool
//
//  2. Declare makeFitCommand in commands.h and add it to the list in commands.cc.
//
// --help, the README's reference, did-you-mean, range checks and the common options (--threads,
// --max-memory, --dry-run, --report, --quiet, --help) come by themselves. Throw innermap's errors;
// they become one line on stderr and exit code 1 (UsageError: 2, Cancelled: 130). Pass
// context.progress() to all settings.
#pragma once

#include <functional>
#include <memory>
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

  // Arguments without a name, in order; required unless .optional(). The last may be a list.
  OptionBuilder positional(const std::string& name, Target target, const std::string& help);
  OptionBuilder option(const std::string& name, const std::string& placeholder, Target target,
                       const std::string& help);
  OptionBuilder flag(const std::string& name, bool* target, const std::string& help);

  void description(std::string text) { description_ = std::move(text); }  // beyond the summary
  void example(std::string line) { examples_.push_back(std::move(line)); }
  void run(std::function<void(Context&)> body) { body_ = std::move(body); }

  const std::string& name() const { return name_; }
  const std::string& summary() const { return summary_; }
  const std::string& description() const { return description_; }
  const std::vector<Option>& options() const { return options_; }
  const std::vector<std::string>& examples() const { return examples_; }
  void execute(Context& context) const { body_(context); }

 private:
  std::string name_, summary_, description_;
  std::vector<Option> options_;
  std::vector<std::string> examples_;
  std::function<void(Context&)> body_;
};

// The options that every command has, bound to `common`.
std::vector<Option> commonOptionTable(CommonOptions& common);

// Parses `arguments` (after the command's name) by the command's table and the common one. Throws
// UsageError, SettingError. Sets `common.help` and checks nothing further when --help is there.
void parseArguments(const Command& command, CommonOptions& common,
                    const std::vector<std::string>& arguments);

// "; did you mean x?" for the nearest of `known`, or "".
std::string didYouMean(const std::string& typed, const std::vector<std::string>& known);

}  // namespace innermap::tool
