#include <mutex>
#include <utility>

#include "innermap/proof/prove.h"
#include "proof/detail/step_trees.h"

namespace innermap {

struct ExpandedMap::Kept {
  std::mutex mutex;
  double scale = 0;
  std::shared_ptr<const proof::StepTrees> trees;
};

ExpandedMap::ExpandedMap(ComposedMap map) : map_(std::move(map)), kept_(std::make_shared<Kept>()) {}

ExpandedMap::ExpandedMap(HarmonicMap map) : ExpandedMap(ComposedMap(std::move(map))) {}

std::shared_ptr<const proof::StepTrees> ExpandedMap::expansions(double scale) const {
  const std::lock_guard<std::mutex> lock(kept_->mutex);
  if (!kept_->trees || kept_->scale != scale) {
    kept_->trees = std::make_shared<const proof::StepTrees>(map_, scale);
    kept_->scale = scale;
  }
  return kept_->trees;
}

}  // namespace innermap
