// What `sequence` writes of its frames, whoever made them.
#pragma once

#include <string>
#include <vector>

#include "context.h"
#include "report/parts.h"
#include "report/sequence_table.h"

namespace innermap::tool {

struct SequenceJudge {
  std::string rest;  // name of the rest pose's mesh
  double tolerance = 0;
  VerdictSettings verdict;
};

// Names of the files that concludeSequence() writes.
std::vector<std::string> sequenceFiles();

// Table, chart, report and verdict. rows: the good ones of `results`, in order.
void concludeSequence(const SequenceJudge& judge, const std::vector<SequenceRow>& rows,
                      const std::vector<FrameResult>& results, Context& context,
                      PendingFolder& folder);

// The figures of a frame, with how its parts move (FrameFit::jumps), and what frames are judged by,
// as parts hold them.
PartValues partValues(const SequenceRow& row, const std::string& jumps);
PartValues partValues(const SequenceJudge& judge);
SequenceRow sequenceRow(const PartValues& values);
SequenceJudge sequenceJudge(const PartValues& values);

}  // namespace innermap::tool
