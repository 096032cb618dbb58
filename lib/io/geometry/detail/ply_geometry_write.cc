#include <algorithm>
#include <array>
#include <numeric>
#include <sstream>

#include "innermap/core/run.h"
#include "io/geometry/detail/ply_geometry.h"

namespace innermap {
namespace {

// Rows that are written by one thread, and how many times as many are held.
constexpr std::size_t kPart = 512, kParts = 64;

// Of every row; 0 where that differs.
std::size_t rowBytes(const PlyElement& element) {
  std::size_t out = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.list) return 0;
    out += plySize(property.type);
  }
  return out;
}

}  // namespace

void PlyGeometry::writeHeader(OutputBuffer& out, const CarriedGeometry& carried) const {
  std::map<PlyRole, std::uint64_t> counts;
  for (const int number : carried.number) counts[PlyRole::vertices] += number >= 0;
  for (std::size_t e = 0; e < geometry.elements.size(); ++e) {
    const PlyRole role = roles_[geometry.elements.source[e]];
    // A line that was split is as many edges as it has parts.
    const std::size_t corners = geometry.elements.start[e + 1] - geometry.elements.start[e];
    if (carried.stays[e]) counts[role] += role == PlyRole::edges ? corners - 1 : 1;
  }
  std::size_t position = 0;
  for (std::size_t e = 0; e < header_.elements.size(); ++e) {
    const std::size_t line = file_.bytes.find("element", position);
    // Comments may have the word too.
    const std::size_t lineBegin = file_.bytes.find_last_of("\r\n", line) + 1;
    if (file_.bytes.find_first_not_of(" \t", lineBegin) != line) {
      copy(out, position, line + 7);
      position = line + 7;
      --e;
      continue;
    }
    const std::size_t end = file_.bytes.find_first_of("\r\n", line);
    copy(out, position, line);
    const PlyElement& element = header_.elements[e];
    const PlyRole role = plyRole(element);
    out.print("element {} {}", element.name, role == PlyRole::other ? element.count : counts[role]);
    position = end;
  }
  copy(out, position, header_.bodyOffset);
}

template <class Use>
void PlyGeometry::forRows(PlyBody& body, const PlyElement& element, std::size_t begin,
                          std::size_t end, const Use& use) const {
  const std::size_t bytes = rowBytes(element), start = body.position();
  if (body.ascii() || bytes == 0) return use(body, begin, end, 0);
  parallelBlocks(end - begin, kPart, [&](std::size_t first, std::size_t last) {
    PlyBody own(file_, header_);
    own.seek(start + first * bytes);
    use(own, begin + first, begin + last, first / kPart);
  });
  body.seek(start + (end - begin) * bytes);
}

void PlyGeometry::writeVertices(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                                const CarriedGeometry& carried) const {
  std::vector<std::size_t> rows;
  if (carried.added > 0) {
    const std::size_t position = body.position();
    for (std::size_t row = 0; row < element.count; ++row) {
      rows.push_back(body.position());
      body.skipRow(element);
    }
    body.seek(position);
  }
  for (std::size_t begin = 0; begin < element.count; begin += kParts * kPart) {
    reportProgress("writing", static_cast<double>(begin) / static_cast<double>(element.count));
    const std::size_t end = std::min<std::size_t>(element.count, begin + kParts * kPart);
    std::array<std::string, kParts> parts;
    forRows(body, element, begin, end,
            [&](PlyBody& own, std::size_t first, std::size_t last, std::size_t part) {
              std::ostringstream text;
              {
                OutputBuffer to(text);
                for (std::size_t row = first; row < last; ++row)
                  writeVertex(to, own, element, row, carried);
              }
              parts[part] = text.str();
            });
    for (const std::string& part : parts) out.raw(part);
  }
  if (carried.added > 0) writeAdded(out, body, element, rows, carried);
}

CarriedSplat PlyGeometry::carrySplat(PlyBody& body, const PlyElement& element, std::size_t row,
                                     const CarriedGeometry& carried) const {
  const std::size_t position = body.position();
  const Splat splat = splats_.read(body, element);
  body.seek(position);
  return carriedSplat(carried.points.jacobians.at(row), splat, carried.splats.opacity);
}

void PlyGeometry::writeVertex(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                              std::size_t row, const CarriedGeometry& carried) const {
  if (carried.number[row] < 0) return body.skipRow(element);
  Splat splat;
  if (splats_.degree() >= 0) splat = carrySplat(body, element, row, carried).splat;
  std::size_t copied = body.position();
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    const std::optional<PlyMoving>& moving = moving_[p];
    const bool ofSplat = moving && moving->direction == PlyMoving::kSplat;
    if (!moving || (ofSplat && moving->axis == PlySplats::kOpacity &&
                    carried.splats.opacity == SplatOpacity::look)) {
      body.skip(property);
      continue;
    }
    const std::string_view bytes = body.next(property.type);
    const auto begin = static_cast<std::size_t>(bytes.data() - file_.bytes.data());
    // Digits come with a space of their own.
    copy(out, copied,
         body.ascii() && begin > copied && file_.bytes[begin - 1] == ' ' ? begin - 1 : begin);
    body.put(out, property.type,
             ofSplat ? PlySplats::valueOf(splat, moving->axis) : moved(*moving, row, carried));
    copied = begin + bytes.size();
  }
  copy(out, copied, body.position());
}

std::uint64_t PlyGeometry::cappedOpacities(const CarriedGeometry& carried) const {
  if (splats_.degree() < 0 || carried.splats.opacity == SplatOpacity::look) return 0;
  PlyBody body(file_, header_);
  body.seek(vertexBody_);
  const std::size_t count = vertices_->count;
  std::vector<std::uint64_t> capped(count / kPart + 1);
  forRows(body, *vertices_, 0, count,
          [&](PlyBody& own, std::size_t first, std::size_t last, std::size_t part) {
            for (std::size_t row = first; row < last; ++row) {
              if (carried.number[row] >= 0)
                capped[part] += carrySplat(own, *vertices_, row, carried).capped;
              own.skipRow(*vertices_);
            }
          });
  return std::accumulate(capped.begin(), capped.end(), std::uint64_t{0});
}

// Properties of points between others are the means of theirs.
void PlyGeometry::writeAdded(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                             const std::vector<std::size_t>& rows,
                             const CarriedGeometry& carried) const {
  const std::size_t after = body.position(), originals = rows.size();
  std::vector<std::vector<double>> made;
  const auto valuesOf = [&](int point) {
    const auto i = static_cast<std::size_t>(point);
    if (i >= originals) return made[i - originals];
    std::vector<double> values;
    body.seek(rows[i]);
    for (const PlyProperty& property : element.properties) {
      if (property.list) body.skip(property);
      values.push_back(property.list ? 0 : body.nextValue(property.type));
    }
    return values;
  };
  for (std::size_t i = 0; i < carried.added; ++i) {
    const auto& [a, b] = geometry.pointMiddles.parents()[i];
    std::vector<double> values = valuesOf(a);
    const std::vector<double> others = valuesOf(b);
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = 0.5 * (values[p] + others[p]);
    made.push_back(values);
    if (carried.number[originals + i] < 0) continue;
    if (body.ascii()) out.raw("\n");
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const std::optional<PlyMoving>& moving = moving_[p];
      if (property.list)
        body.put(out, property.countType, 0);
      else
        body.put(out, property.type, moving ? moved(*moving, originals + i, carried) : values[p]);
    }
  }
  body.seek(after);
}

std::vector<double> PlyGeometry::textureAt(int texture) const {
  const auto i = static_cast<std::size_t>(texture);
  const std::size_t originals = textures_.size() / 2;
  if (i < originals) return {textures_[2 * i], textures_[2 * i + 1]};
  const auto& [a, b] = geometry.textureMiddles.parents()[i - originals];
  const std::vector<double> from = textureAt(a), to = textureAt(b);
  return {0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])};
}

// The row at the body's position, with the corners of element `which` in place of its own.
void PlyGeometry::writeElement(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                               std::size_t which) const {
  const Elements& elements = geometry.elements;
  const std::size_t begin = elements.start[which], end = elements.start[which + 1];
  const bool edges = plyRole(element) == PlyRole::edges;
  const auto number = [&](std::size_t k) {
    const int point = elements.corners[k].point;
    return point < 0 ? -1.0 : carried_->number[static_cast<std::size_t>(point)];
  };
  const std::size_t row = body.position();
  for (std::size_t part = 0; part < (edges ? end - begin - 1 : 1); ++part) {
    body.seek(row);
    if (body.ascii()) out.raw("\n");
    for (const PlyProperty& property : element.properties) {
      std::vector<std::string_view> kept(body.items(property));
      for (std::string_view& bytes : kept) bytes = body.next(property.type);
      std::vector<double> values;
      const PlyPart what = plyPart(plyRole(element), property);
      if (what == PlyPart::end) values = {number(begin + part + (property.name == "vertex2"))};
      if (what == PlyPart::corners)
        for (std::size_t k = begin; k < end; ++k) values.push_back(number(k));
      if (what == PlyPart::uvs && begin < end && elements.corners[begin].texture >= 0)
        for (std::size_t k = begin; k < end; ++k)
          for (const double value : textureAt(elements.corners[k].texture)) values.push_back(value);
      if (!values.empty()) kept.clear();
      if (property.list)
        body.put(out, property.countType, static_cast<double>(kept.size() + values.size()));
      for (const std::string_view bytes : kept) body.put(out, bytes);
      for (const double value : values) body.put(out, property.type, value);
    }
  }
}

std::vector<std::string> PlyGeometry::write(const std::string&, const CarriedGeometry& carried,
                                            std::ostream& stream) const {
  carried_ = &carried;
  OutputBuffer out(stream);
  writeHeader(out, carried);
  PlyBody body(file_, header_);
  std::size_t next = 0, fileElement = 0;
  for (const PlyElement& element : header_.elements) {
    const PlyRole role = plyRole(element);
    if (role == PlyRole::vertices) {
      writeVertices(out, body, element, carried);
      continue;
    }
    for (std::uint64_t left = body.rows(element); left > 0; --left) {
      const std::size_t begin = body.position();
      body.skipRow(element);
      const std::size_t end = body.position();
      if (role == PlyRole::other || unchanged(carried)) {
        copy(out, begin, end);
        continue;
      }
      for (; next < geometry.elements.size() && geometry.elements.source[next] == fileElement;
           ++next) {
        if (!carried.stays[next]) continue;
        body.seek(begin);
        writeElement(out, body, element, next);
      }
      body.seek(end);
      ++fileElement;
    }
  }
  copy(out, body.position(), file_.bytes.size());
  return {};
}

}  // namespace innermap
