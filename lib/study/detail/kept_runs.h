// Finished runs of a study in a folder, a file each.
#pragma once

#include <optional>
#include <string>

#include "innermap/study/study.h"

namespace innermap {

class KeptRuns {
 public:
  // settings.folder empty: keeps nothing.
  KeptRuns(const BoundaryPair& pair, const StudySettings& settings);

  // A file that is damaged, or another run's, is as none.
  std::optional<StudyRow> find(const StudyRun& run) const;

  // Throws FileError.
  void keep(const StudyRow& row) const;

 private:
  std::string keyOf(const StudyRun& run) const;
  std::string pathOf(const std::string& key) const;

  std::string folder_, common_;
};

}  // namespace innermap
