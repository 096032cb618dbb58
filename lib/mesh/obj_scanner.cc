#include "mesh/obj_scanner.h"

#include <fmt/format.h>

#include <limits>

namespace innermap {
namespace {

ObjLine kindOf(std::string_view keyword) {
  if (keyword == "v") return ObjLine::vertex;
  if (keyword == "vn") return ObjLine::normal;
  if (keyword == "vt") return ObjLine::texture;
  if (keyword == "f" || keyword == "fo") return ObjLine::face;  // fo: in files before OBJ 3.0
  if (keyword == "l") return ObjLine::line;
  return keyword == "p" ? ObjLine::points : ObjLine::other;
}

}  // namespace

bool ObjScanner::next() {
  if (!text_.nextFilledLine(keyword_)) return false;
  kind_ = kindOf(keyword_);
  vertex_.count += kind_ == ObjLine::vertex;
  texture_.count += kind_ == ObjLine::texture;
  normal_.count += kind_ == ObjLine::normal;
  return true;
}

double ObjScanner::fraction() const {
  const auto position = static_cast<double>(text_.position());
  return position / (position + static_cast<double>(text_.remainingBytes()));
}

const std::vector<ObjCorner>& ObjScanner::corners() {
  corners_.clear();
  for (std::string_view word; text_.token(word);) corners_.push_back(corner(word));
  const std::size_t least = kind_ == ObjLine::face ? 3 : kind_ == ObjLine::line ? 2 : 1;
  if (corners_.size() < least)
    text_.fail(fmt::format("'{}' needs {} corners, here are {}", keyword_, least, corners_.size()));
  return corners_;
}

// v, v/vt, v//vn or v/vt/vn
ObjCorner ObjScanner::corner(std::string_view word) {
  ObjCorner corner;
  const std::size_t slash = word.find('/');
  corner.vertex = index(word.substr(0, slash), vertex_);
  if (slash == word.npos) return corner;
  const std::string_view rest = word.substr(slash + 1);
  const std::size_t second = rest.find('/');
  if (const std::string_view texture = rest.substr(0, second); !texture.empty())
    corner.texture = index(texture, texture_);
  if (second == rest.npos || second + 1 == rest.size()) return corner;
  const std::string_view normal = rest.substr(second + 1);
  if (normals_)
    corner.normal = index(normal, normal_);
  else
    text_.integer(normal);
  return corner;
}

int ObjScanner::index(std::string_view word, Channel& channel) const {
  const std::int64_t value = text_.integer(word);
  if (value == 0) text_.fail(fmt::format("{} index 0; OBJ counts from 1", channel.name));
  if (value < -channel.count || value > std::numeric_limits<int>::max())
    text_.fail(fmt::format("{} index {} is out of range, the file has {} there", channel.name,
                           value, channel.count));
  if (value > channel.highest) {
    channel.highest = value;
    channel.byte = text_.position();
  }
  return static_cast<int>(value > 0 ? value - 1 : channel.count + value);
}

void ObjScanner::requireInRange() const {
  for (const Channel* channel : {&vertex_, &texture_, &normal_})
    if (channel->highest > channel->count)
      failAt(text_.file(), channel->byte,
             fmt::format("{} index {} is out of range, the file has {}", channel->name,
                         channel->highest, channel->count));
}

}  // namespace innermap
