// The job of an animation's frames: which of them, what they need, and what becomes of one that
// cannot be used.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/frame_files.h"
#include "innermap/core/error.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/io/vdb_file.h"
#include "innermap/transfer/push_pull.h"
#include "jobs/needs.h"

namespace innermap {

// Places in `numbers`, which ascend, of the frames that `ranges` names, as FrameRanges has them;
// empty: all. Throws SettingError naming `setting` where it names none.
std::vector<std::size_t> wantedFrames(const std::vector<std::int64_t>& numbers,
                                      const std::string& setting, const std::string& ranges);

// What goes on beside the frames: each may be missing.
struct FrameWatch {
  // Before a frame, the number of those that came before; false: it is left, with all after it.
  std::function<bool(std::size_t)> begins;
  // After it: its place among all, and what became of it.
  std::function<void(std::size_t, FrameResult&)> ended;
};

// Calls `body` for all frames wanted, in order, with the frame's place among all. One that cannot
// be used, by a FileError or a DataError of `body`, has that as its error, and the others go on.
std::vector<FrameResult> eachFrame(const std::vector<std::size_t>& wanted, const FrameWatch& watch,
                                   const std::function<void(std::size_t)>& body);

// The result of a frame cannot be written (a full disk, say): the whole run ends.
class OutputFailure : public Error {
 public:
  using Error::Error;
};
// Calls `write`; its FileErrors become OutputFailures that name the frame.
void writeFrame(std::int64_t number, const std::function<void()>& write,
                const std::string& unit = "frame");

// The fits of frames as they are asked for. read: the frame at a place in `numbers`. fitted: told
// of each. The fitter must outlive them.
FrameFits frameFits(const FrameFitter& fitter, std::vector<std::int64_t> numbers,
                    std::function<Mesh(std::size_t)> read,
                    std::function<void(std::size_t, const Mesh&, const FrameFit&)> fitted = {});

// Throws DataError where none can be used. errors: of each frame, empty for a good one. unit: what
// one is called.
void requireOneGood(const std::vector<std::string>& errors, const std::string& unit = "frame");

// What a frame's warning is told as: "frame 12: ..."; and one that cannot be used.
std::string frameWarning(std::int64_t number, const std::string& warning);
std::string frameLeftOut(std::int64_t number, const std::string& error,
                         const std::string& unit = "frame");

// others: bytes that a frame takes beside its fit.
MemoryNeed framesNeed(const FrameFitterSettings& settings, std::uint64_t others);
// Of measuring maps from this rest pose on grids.
MemoryNeed sequenceNeed(const FrameFitterSettings& settings, const Solid& rest,
                        const MapGridSettings& grids);

// How grids are carried through frames.
struct FrameCarry {
  CarrySettings carry;
  FrameOutside outside;
  LevelSetSettings output;  // voxels of the grids made
  bool velocity = false;    // also a grid of that name, for motion blur
  double framesPerSecond = 24;
  double shutter = kUsualShutter;  // frames that it is open for: the velocity goes on that far
};

FramePushSettings pushSettings(const FrameCarry& how);

// What is carried beside the grids, to the frame at this place among all.
std::vector<CarriedField> carriedFields(const FrameCarry& how, FrameFits& fits, std::size_t index);

std::uint64_t frameCarryMemory(const Solid& rest, const openvdb::GridPtrVec& grids,
                               const FrameCarry& how);

// Throws DataError naming `from` where a grid already has the name that the velocity is to get.
void requireNoVelocity(const FrameCarry& how, const openvdb::GridPtrVec& grids, NamingScheme names,
                       const std::string& from, const SettingSpelling& spelled);

}  // namespace innermap
