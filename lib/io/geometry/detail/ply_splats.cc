#include "io/geometry/detail/ply_splats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr int kFirstHarmonic = PlySplats::kOpacity + 1;
constexpr char kRest[] = "f_rest_";

const std::vector<std::string>& names() {
  static const std::vector<std::string> all{"scale_0", "scale_1", "scale_2", "rot_0",
                                            "rot_1",   "rot_2",   "rot_3",   "opacity"};
  return all;
}

// The number behind "f_rest_"; none of other names.
std::optional<std::int64_t> restNumber(const std::string& name) {
  if (name.rfind(kRest, 0) != 0) return std::nullopt;
  return parseInteger(std::string_view(name).substr(sizeof kRest - 1));
}

bool has(const PlyElement& vertices, const std::string& name) {
  return std::any_of(vertices.properties.begin(), vertices.properties.end(),
                     [&](const PlyProperty& p) { return p.name == name; });
}

bool areSplats(const PlyElement& vertices) {
  return has(vertices, "scale_0") && has(vertices, "rot_0");
}

int degreeOf(const std::string& path, std::int64_t count) {
  for (int degree = 0; degree <= 3; ++degree)
    if (count == 3 * ((degree + 1) * (degree + 1) - 1)) return degree;
  throw FileError(path,
                  fmt::format("has {} properties f_rest_0, f_rest_1 and so on; splats have 0, "
                              "9, 24 or 45, for colours of degree 0 to 3",
                              count));
}

}  // namespace

PlySplats::PlySplats(const std::string& path, const PlyElement& vertices) {
  if (!areSplats(vertices)) return;
  const auto fail = [&](const std::string& what) {
    throw FileError(path, "has scale_0 and rot_0, as Gaussian splats have, but " + what +
                              "; export it again as the reference implementation does");
  };
  const auto& known = names();
  std::int64_t rest = 0;
  for (const PlyProperty& p : vertices.properties) rest += restNumber(p.name).has_value();
  degree_ = degreeOf(path, rest);
  parts_.assign(vertices.properties.size(), kNone);
  std::vector<bool> found(kFirstHarmonic + static_cast<std::size_t>(rest));
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const PlyProperty& property = vertices.properties[p];
    const auto at = std::find(known.begin(), known.end(), property.name);
    if (at != known.end())
      parts_[p] = static_cast<int>(at - known.begin());
    else if (const auto number = restNumber(property.name); !number)
      continue;
    else if (*number < 0 || *number >= rest)
      fail(fmt::format("'{}' is not one of {} that start at 0", property.name, rest));
    else
      parts_[p] = kFirstHarmonic + static_cast<int>(*number);
    if (property.list || !isFloat(property.type))
      fail(inQuotes(property.name) + " is neither float nor double");
    if (found[static_cast<std::size_t>(parts_[p])])
      fail(inQuotes(property.name) + " is there twice");
    found[static_cast<std::size_t>(parts_[p])] = true;
  }
  for (std::size_t i = 0; i < known.size(); ++i)
    if (!found[i]) fail("no '" + known[i] + "'");
}

double& PlySplats::valueOf(Splat& splat, int part) {
  if (part < 3) return splat.logScales[part];
  if (part < kOpacity) return splat.quaternion[static_cast<std::size_t>(part - 3)];
  if (part == kOpacity) return splat.opacity;
  return splat.harmonics[static_cast<std::size_t>(part - kFirstHarmonic)];
}

void PlySplats::check(const PlyBody& body, std::uint64_t row, Splat& splat, int degree) {
  const auto fail = [&](const char* what) {
    body.fail(fmt::format("splat {} {}; leave it out or export the file again", row, what));
  };
  double length = 0;  // squared
  for (const double q : splat.quaternion) length += q * q;
  if (!std::isfinite(length)) fail("has a quaternion (rot_0 to rot_3) that is not finite");
  if (!(length > 0)) fail("has a quaternion (rot_0 to rot_3) of length 0");
  if (!isFinite(splat.logScales)) fail("has a scale that is not finite");
  if (std::isnan(splat.opacity)) fail("has an opacity that is no number");
  const int count = 3 * ((degree + 1) * (degree + 1) - 1);
  if (!std::all_of(splat.harmonics.begin(), splat.harmonics.begin() + count,
                   [](double h) { return std::isfinite(h); }))
    fail("has a colour (f_rest) that is not finite");
}

Splat PlySplats::read(PlyBody& body, const PlyElement& vertices) const {
  Splat out;
  out.degree = degree_;
  for (std::size_t p = 0; p < parts_.size(); ++p)
    if (parts_[p] == kNone)
      body.skip(vertices.properties[p]);
    else
      valueOf(out, parts_[p]) = body.nextValue(vertices.properties[p].type);
  return out;
}

std::uint64_t plySplatsMemory(const FileBytes& head, std::uint64_t size) {
  if (head.bytes.find("end_header") == head.bytes.npos) return 0;
  const PlyHeader header = readPlyHeader(head);
  for (const PlyElement& element : header.elements) {
    if (plyRole(element) != PlyRole::vertices || !areSplats(element)) continue;
    std::uint64_t row = 0;
    for (const PlyProperty& p : element.properties)
      row += header.format == PlyFormat::ascii ? 2 : plySize(p.list ? p.countType : p.type);
    const std::uint64_t count = std::min(element.count, size / row);
    // Places and normals, as read and as carried, with new numbers.
    constexpr std::uint64_t kEach = 2 * sizeof(Vec3) + sizeof(int) + sizeof(Vec3) + sizeof(int);
    return size + count * kEach + carryPointsMemory(count, true);
  }
  return 0;
}

}  // namespace innermap
