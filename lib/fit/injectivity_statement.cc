// What is known of a map's being one-to-one, in words.
#include <fmt/format.h>

#include <cmath>

#include "fit/detail/proof_words.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {

namespace {

struct Kind {
  const DeterminantFigures& figures;
  const char* name;
};

std::vector<Kind> checkedKinds(const Injectivity& known) {
  std::vector<Kind> out;
  for (const Kind& kind :
       {Kind{known.inside, "points inside"}, Kind{known.boundary, "points of the boundary"},
        Kind{known.voxels, "voxels"}, Kind{known.cells, "cells between voxels"}})
    if (kind.figures.checked > 0) out.push_back(kind);
  return out;
}

// "a, b and c"
std::string listed(const std::vector<std::string>& items) {
  std::string out;
  for (std::size_t i = 0; i < items.size(); ++i)
    out += (i == 0 ? "" : i + 1 < items.size() ? ", " : " and ") + items[i];
  return out;
}

std::string percent(double share) { return fmt::format("{:.2g}%", 100 * share); }

// Of det J itself.
std::string leastOf(const DeterminantFigures& f, bool mirrored) {
  return mirrored ? fmt::format("greatest {:.3g}", -f.least) : fmt::format("least {:.3g}", f.least);
}

std::string soundOf(const Kind& kind, bool mirrored) {
  return fmt::format("all {} {} ({})", kind.figures.checked, kind.name,
                     leastOf(kind.figures, mirrored));
}

std::string foldedOf(const Kind& kind, bool mirrored) {
  const DeterminantFigures& f = kind.figures;
  std::string out =
      fmt::format("{} of {} {} ({}, {}", f.folded, f.checked, kind.name,
                  percent(static_cast<double>(f.folded) / static_cast<double>(f.checked)),
                  leastOf(f, mirrored));
  if (f.foldedAtOverlap > 0)
    out += fmt::format("; {} where the target runs through itself",
                       f.foldedAtOverlap == f.folded ? "all" : std::to_string(f.foldedAtOverlap));
  return out + ")";
}

std::string determinants(const Injectivity& known) {
  const bool mirrored = known.mirrored;
  std::vector<std::string> sound, folded;
  for (const Kind& kind : checkedKinds(known))
    if (kind.figures.folded == 0)
      sound.push_back(soundOf(kind, mirrored));
    else
      folded.push_back(foldedOf(kind, mirrored));
  std::string out;
  if (!sound.empty()) out += fmt::format("det J {} 0 at {}. ", mirrored ? "<" : ">", listed(sound));
  if (!folded.empty())
    out += fmt::format("det J is not {} 0 at {}. ", mirrored ? "below" : "above", listed(folded));
  if (out.empty()) out = "No points inside were checked. ";
  if (known.repaired > 0)
    out += fmt::format("{} voxel{} repaired, where the grids differ from the map. ", known.repaired,
                       known.repaired == 1 ? " was" : "s were");
  return out;
}

// "3 cells, 0.1% of the solid at most, "
std::string cellsOf(std::size_t count, double share) {
  return fmt::format("{} cell{}, {}% of the solid at most, ", count, count == 1 ? "" : "s",
                     atMost(100 * share, 2));
}

// Cells on which det J is proven to have the map's sign.
std::size_t decided(const ProofFigures& p) { return p.cells - p.undecided - p.negative; }

std::string proofWords(const ProofFigures& p) {
  if (p.cells == 0) return "";
  const char* sign = p.mirrored ? "<" : ">";
  std::string out =
      p.whole() ? fmt::format(
                      "Proven: det J {} 0 everywhere in the solid, on {} cells (size {} "
                      "at least). ",
                      sign, p.cells, atLeast(p.least))
                : fmt::format("Proven: det J {} 0 in {}% of the solid at least, on {} cells. ",
                              sign, atLeast(100 * p.proven, 6), decided(p));
  if (p.negative > 0)
    out += "On " + cellsOf(p.negative, p.negativeShare) + "it has the other sign everywhere. ";
  if (p.undecided > 0) out += "On " + cellsOf(p.undecided, p.undecidedShare) + "it is undecided. ";
  if (p.boundaryError > 0)
    out += fmt::format(
        "No point of the boundary is farther than {} of the target's diagonal from where it "
        "should be. ",
        atMost(p.boundaryError));
  else
    out += "It is not decided how far the boundary is off at most. ";
  if (p.oneToOne > 0)
    out += "No two points of the solid go to one: it is mapped one-to-one as a whole. ";
  if (p.oneToOne == 0) out += "It is not decided whether two points of the solid go to one. ";
  return out;
}

std::string times(int count) {
  return count == 1 ? "once" : fmt::format("{} time{}", count, std::abs(count) == 1 ? "" : "s");
}

std::string boundary(const Injectivity& known) {
  std::string out;
  if (known.outside > 0)
    out += percent(known.outside) +
           " of the points inside land outside the target by more than the error of 99% of the "
           "boundary. ";
  const DegreeFigures& degree = known.degree;
  const std::string within = fmt::format(
      "99% of the boundary's image is within {:.2g} of the target's diagonal of the target",
      known.boundaryError);
  if (degree.checked > 0)
    out += fmt::format(
        "{}, and winds {} about the {} points checked deeper inside the target{}. ", within,
        degree.least == degree.greatest
            ? times(degree.least)
            : fmt::format("{} to {}", degree.least, times(degree.greatest)),
        degree.checked,
        degree.least == degree.greatest ? fmt::format(" (degree {})", degree.least) : "");
  else if (known.boundary.checked > 0)
    out += within + "; no point of the target lies deeper, so its degree is not known. ";
  return out;
}

std::string crossing(const char* what, const SelfIntersectionFigures& figures) {
  std::string out = fmt::format("The {} runs through itself: {} pair{} of triangles", what,
                                figures.pairs, figures.pairs == 1 ? "" : "s");
  if (!figures.places.empty()) {
    const Vec3& p = figures.places.front();
    out += fmt::format(", the first near ({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z);
  }
  return out + ". ";
}

std::string surfaces(const Injectivity& known) {
  if (known.source.pairs == 0 && known.target.pairs == 0)
    return known.solid.caps == 0
               ? "Neither surface runs through itself. "
               : "Neither surface runs through itself; the caps over holes were not checked. ";
  std::string out;
  if (known.source.pairs > 0)
    out += crossing("source", known.source) + "Parts that overlap there are mapped as one solid. ";
  if (known.target.pairs > 0) out += crossing("target", known.target);
  if (known.target.pairs > 0 && known.source.pairs == 0)
    out += "No continuous map that meets this target exactly can be one-to-one. ";
  return out;
}

// The signs of det J that were found somewhere: that of the target's sense, and the other.
struct Signs {
  bool kept = false, turned = false;
  bool both() const { return kept && turned; }
};

Signs signsOf(const Injectivity& known) {
  const ProofFigures& p = known.proof;
  Signs out{p.cells > 0 && decided(p) > 0, p.negative > 0};
  if (p.mirrored != known.mirrored) std::swap(out.kept, out.turned);
  for (const DeterminantFigures* f : {&known.inside, &known.boundary, &known.voxels}) {
    out.kept = out.kept || f->checked > f->folded;
    out.turned = out.turned || (f->folded > 0 && f->least < 0);  // 0 has no sign
  }
  return out;
}

bool anyFolded(const Injectivity& known) {
  return known.proof.negative + known.inside.folded + known.boundary.folded + known.voxels.folded >
         0;
}

// Each part of a solid may be turned over as a whole, so that only twice tells of all together.
bool windsOtherwise(const Injectivity& known) {
  const DegreeFigures& d = known.degree;
  return d.greatest > 1 || d.least < -1 ||
         (known.solid.parts == 1 && d.least < 0 && d.greatest > 0);
}

std::string windingWords(const Injectivity& known) {
  const DegreeFigures& degree = known.degree;
  std::string out;
  if (degree.greatest > 1)
    out += fmt::format("So the map is not one-to-one: its boundary winds up to {} about a point. ",
                       times(degree.greatest));
  if (degree.least < 0 && windsOtherwise(known))
    out += fmt::format(
        "So the map is not one-to-one: its boundary winds {} about a point, and turns over the "
        "points that go there. ",
        times(degree.least));
  return out;
}

std::string foldWords(const Injectivity& known) {
  if (!signsOf(known).both()) return "";
  return known.solid.parts == 1 ? "So the map is not one-to-one: it turns over those places. "
                                : "The solid has several parts: on a part that is turned over only "
                                  "in places, the map is not one-to-one. ";
}

std::string conclusion(const Injectivity& known) {
  const DegreeFigures& degree = known.degree;
  std::string out = foldWords(known) + windingWords(known);
  if (countsPreimages(known)) out += "By these proofs " + preimages(known) + ". ";
  if (notOneToOne(known) || known.proof.whole()) return out;
  if (known.inside.checked == 0 && known.voxels.checked == 0)
    return "It is not known whether the map is one-to-one. ";
  if (signsOf(known).both()) return out;
  if (known.mirrored)
    return out +
           "The map mirrors the solid, as its target is inside out; no check rules out that it is "
           "one-to-one. ";
  if (degree.checked == 0 || degree.least != 1 || anyFolded(known))
    return out + "No check rules out that the map is one-to-one, and none proves it. ";
  if (countsPreimages(known)) return out;
  return fmt::format(
      "If det J > 0 everywhere inside, as many points go to a place as the image of the boundary "
      "winds about it. Then exactly one point goes to each of those {} points, and to all places "
      "that can be reached from them without crossing that image. Between the checked points, det "
      "J > 0 is not proven. ",
      degree.checked);
}

std::string cells(const CellFigures& cells) {
  if (cells.checked == 0 || cells.folded > 0) return "";
  const std::string what = fmt::format(
      "Proven of the grid {}, repaired or not: the map that is linear on its {} cells, {} of the "
      "solid, turns none of them over",
      cells.local ? "map_local" : "map", cells.checked, percent(cells.share));
  if (cells.overlaps == 0) return what + ", and is one-to-one as a whole. ";
  if (cells.overlaps < 0) return what + ". That is local: their images may still overlap. ";
  return what + fmt::format(
                    ", but is not one-to-one: their images overlap at {} place{} of their "
                    "boundary. ",
                    cells.overlaps, cells.overlaps == 1 ? "" : "s");
}

}  // namespace

bool notOneToOne(const Injectivity& known) {
  return windsOtherwise(known) || (known.solid.parts == 1 && signsOf(known).both());
}

std::string injectivityStatement(const Injectivity& known) {
  std::string out = proofWords(known.proof) + determinants(known) + boundary(known) +
                    surfaces(known) + conclusion(known) + cells(known.cells);
  out.pop_back();
  return out;
}

std::string injectivityLine(const Injectivity& known) {
  std::vector<std::string> sound, folded;
  for (const Kind& kind : checkedKinds(known)) {
    const DeterminantFigures& f = kind.figures;
    if (f.folded == 0)
      sound.push_back(fmt::format("{} {}", f.checked, kind.name));
    else
      folded.push_back(fmt::format("{} of {} {}", f.folded, f.checked, kind.name));
  }
  if (sound.empty() && folded.empty()) return "one-to-one: not checked";
  const ProofFigures& p = known.proof;
  std::string out = notOneToOne(known) ? "not one-to-one"
                    : p.oneToOne > 0   ? "one-to-one, proven"
                    : countsPointsOnce(known)
                        ? "one-to-one, proven deeper than " + atMost(p.boundaryError)
                    : p.whole()        ? "nowhere folded, proven"
                    : anyFolded(known) ? "turned over in places"
                                       : "one-to-one as far as checked";
  if (p.negative > 0) out += fmt::format("; proven to fold on {} cells", p.negative);
  if (p.undecided > 0)
    out += fmt::format("; {}% of the solid undecided", atMost(100 * p.undecidedShare, 2));
  if (!folded.empty()) out += "; folded: " + listed(folded);
  if (!sound.empty())
    out += (known.mirrored ? "; mirrored, no fold at " : "; no fold at ") + listed(sound);
  if (windsOtherwise(known))
    out += fmt::format("; the boundary winds {} to {}", known.degree.least,
                       times(known.degree.greatest));
  if (known.target.pairs > 0)
    out += fmt::format("; the target runs through itself in {} pair{} of triangles",
                       known.target.pairs, known.target.pairs == 1 ? "" : "s");
  return out;
}

}  // namespace innermap
