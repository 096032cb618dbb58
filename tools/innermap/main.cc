// The innermap program: finds the command, parses its options, turns errors into exit codes.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <new>
#include <regex>

#include "commands.h"
#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "report/parts.h"
#include "run_record.h"
#include "signals.h"
#include "terminal_progress.h"
#include "version.h"

namespace innermap::tool {
namespace {

enum ExitCode { kDone = 0, kFailed = 1, kUsage = 2, kCancelled = 130 };

void execute(const Command& command, const CommonOptions& common, TerminalProgress& progress) {
  Context context(common, progress);
  for (const Option& option : command.options()) {
    if (!option.isInput) continue;
    if (const auto text = std::get_if<std::string*>(&option.target)) context.input(**text);
  }
  if (!common.report.empty()) context.output(common.report);
  if (!common.cpuTarget.empty()) keepToCpu("--cpu-target", common.cpuTarget);
  // Never undone: TBB would start the threads that were kept from it.
  static const auto* const threads = new ThreadLimit(common.threads);
  static_cast<void>(threads);
  recordRun(command, common, context.report());
  for (const std::string& text : common.notes) context.note(text);
  try {
    command.execute(context);
  } catch (const CancelledLate&) {
    throw;
  } catch (const Cancelled&) {
    // It came too late: what was asked for is there.
    if (!context.allInPlace()) throw;
  }
  ignoreSignals();
  context.finishPage();
  if (!common.report.empty() && !common.dryRun) {
    std::fflush(stdout);  // the report may go there too
    writeReport(common.report, context.finishedReport());
  }
  context.conclude();
  if (common.json) std::fputs(reportJson(context.finishedReport()).c_str(), stdout);
  if (!context.failure().empty()) throw DataError(context.failure());
}

// Words with '_' that are names of settings become options.
std::string withOptions(const Command& command, const std::string& text) {
  static const std::regex kNames("\\b[a-z]+(_[a-z]+)+\\b");
  std::string out;
  auto at = text.begin();
  for (std::sregex_iterator name(text.begin(), text.end(), kNames), end; name != end; ++name) {
    out.append(at, (*name)[0].first);
    const std::string option = optionName(name->str());
    const bool known = std::any_of(command.options().begin(), command.options().end(),
                                   [&](const Option& o) { return o.name == option; });
    out += known ? option : name->str();
    at = (*name)[0].second;
  }
  return out.append(at, text.end());
}

// The library's name of a setting becomes that of the option which gave it: "voxel size: ..." reads
// "--voxel-size: ...".
std::string inOptions(const Command& command, const std::string& error) {
  const auto letters = [](const std::string& text) {
    std::string out;
    for (const char c : text)
      if (std::isalnum(static_cast<unsigned char>(c)))
        out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return out;
  };
  const std::size_t colon = error.find(": ");
  for (const Option& o : command.options())
    if (!o.isPositional() && letters(o.name) == letters(error.substr(0, colon)))
      return o.name + withOptions(command, error.substr(colon));
  return error;
}

void runCommand(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    std::fputs(shortHelp().c_str(), stdout);
    return;
  }
  const std::string& first = arguments.front();
  const auto printVersion = [] { std::fputs(versionAndLibraries().c_str(), stdout); };
  if (first == "--version" || first == "-V") return printVersion();
  if (first == "--help" || first == "-h" || first == "--help-all") {
    std::fputs(generalHelp().c_str(), stdout);
    return;
  }
  const Command command = findCommand(first);
  CommonOptions common;
  parseArguments(command, common, {arguments.begin() + 1, arguments.end()});
  common.maxTime = command.maxTime();
  common.space = command.space();
  if (common.version) return printVersion();
  if (common.help || common.helpAll) {
    std::fputs(commandHelp(command, common.helpAll).c_str(), stdout);
    return;
  }
  // Signals may come until the very end of the process.
  static TerminalProgress progress(TerminalProgress::styleFor(common.quiet, common.verbose));
  handleSignals(progress);
  const RunScope scope(progress);
  try {
    execute(command, common, progress);
  } catch (const SettingError& error) {
    progress.clear();
    throw Error(inOptions(command, error.what()));
  } catch (...) {
    progress.clear();
    throw;
  }
  progress.clear();
}

// One line, whatever a file's name or another library's message holds. Allocates nothing: there may
// be no memory.
int fail(int code, const char* message) {
  std::fputs("innermap: ", stderr);
  for (; *message; ++message) {
    const auto c = static_cast<unsigned char>(*message);
    std::fputc(c < 32 || c == 127 ? ' ' : c, stderr);
  }
  std::fputc('\n', stderr);
  return code;
}

int run(int argc, char** argv) {
  try {
    runCommand({argv + (argc > 0), argv + argc});
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      return fail(kFailed, "standard output cannot be written");
    return kDone;
  } catch (const CancelledLate& cancelled) {
    return fail(kCancelled, cancelled.what());
  } catch (const Cancelled&) {
    return fail(kCancelled, outputsInPlace() == 0
                                ? "cancelled; nothing was written"
                                : "cancelled; some of the outputs are in place, others are not");
  } catch (const UsageError& error) {
    return fail(kUsage, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kFailed, kMemoryExhausted);
  } catch (const std::exception& error) {
    return fail(kFailed, reasonOf(error));
  } catch (...) {
    return fail(kFailed, "an unknown error occurred");
  }
}

}  // namespace
}  // namespace innermap::tool

int main(int argc, char** argv) { return innermap::tool::run(argc, argv); }
