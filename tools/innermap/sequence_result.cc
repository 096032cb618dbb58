#include "sequence_result.h"

#include "frame_loop.h"

namespace innermap::tool {

std::vector<std::string> sequenceFiles() { return {"energies.csv", "energies.svg", "report.json"}; }

void concludeSequence(const SequenceJudge& judge, const std::vector<SequenceRow>& rows,
                      const std::vector<FrameResult>& results, Context& context,
                      PendingFolder& folder) {
  const std::string seconds = secondsText(results, context);
  const std::vector<SequenceRow> table = withBroken(rows, results);
  fillReport(table, context.report());
  std::vector<JudgedFrame> judged;
  for (const SequenceRow& r : rows)
    judged.push_back({r.file.number, r.error.p99, r.folded, r.outside});
  context.judge(judgeFrames(judged, judge.tolerance, judge.verdict));
  context.timed("write", [&] {
    folder.write("energies.csv", [&](const std::string& path) { writeSequenceTable(path, table); });
    folder.write("energies.svg", [&](const std::string& path) {
      writeChart(path, sequenceChart(table, judge.rest));
    });
  });
  context.print(seconds);
}

PartValues partValues(const SequenceRow& row, const std::string& jumps) {
  PartValues values;
  eachNumber(
      row, [&](const char* key, double value, const auto&...) { values.emplace_back(key, value); });
  values.emplace_back("samples", static_cast<std::uint64_t>(row.error.samples));
  values.emplace_back("misses", row.misses);
  values.emplace_back("jumps", jumps);
  values.emplace_back("statement", row.statement);
  Injectivity known;
  known.proof = row.proof;
  for (const auto& [key, number] : injectivityFacts(known)) values.emplace_back(key, number);
  return values;
}

SequenceRow sequenceRow(const PartValues& values) {
  SequenceRow row;
  eachNumber(
      row, [&](const char* key, double& value, const auto&...) { value = numberAt(values, key); });
  row.error.samples = static_cast<decltype(row.error.samples)>(countAt(values, "samples"));
  row.misses = countAt(values, "misses") != 0;
  row.statement = textAt(values, "statement");
  Facts facts;
  for (const auto& [key, value] : values)
    if (const auto* text = std::get_if<std::string>(&value)) facts.emplace_back(key, *text);
  Injectivity known;
  readInjectivity(facts, known);
  row.proof = known.proof;
  return row;
}

PartValues partValues(const SequenceJudge& judge) {
  return {{"rest", judge.rest},
          {"tolerance", judge.tolerance},
          {"max_folded", judge.verdict.maxFolded},
          {"max_outside", judge.verdict.maxOutside}};
}

SequenceJudge sequenceJudge(const PartValues& values) {
  SequenceJudge judge;
  judge.rest = textAt(values, "rest");
  judge.tolerance = numberAt(values, "tolerance");
  judge.verdict.maxFolded = numberAt(values, "max_folded");
  judge.verdict.maxOutside = numberAt(values, "max_outside");
  return judge;
}

}  // namespace innermap::tool
