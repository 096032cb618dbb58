#include <algorithm>

#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_harmonic.h"
#include "innermap/fit/fit_map.h"
#include "report/figures.h"

namespace innermap {
namespace {

Figures boundFigures(double p99Bound, double bound) {
  return {{"p99_bound", p99Bound, "99% within, for sure",
           "bound on the share of 99%, with the confidence below", kDiagonals},
          {"bound", bound, "bound",
           "no point of the map is farther off than this, with the confidence below, if it is "
           "harmonic inside",
           kDiagonals},
          {"confidence", kCertificateConfidence, "confidence", "of the two bounds", kShare}};
}

Figure sumOfSquares(double cError) {
  return {"c_error", cError, "C-Error",
          "sum of squares at the points that were fitted, the paper's measure"};
}

Figures determinantFigures(const std::string& key, const std::string& name,
                           const std::string& where, const DeterminantFigures& d) {
  return when(d.checked > 0,
              {{key + "_checked", d.checked, name, where},
               {key + "_folded", d.folded, "of these folded", "the map turns them inside out"},
               {key + "_folded_at_overlap", d.foldedAtOverlap, "of these at overlaps",
                "where the target runs through itself and no map can be one-to-one"},
               {key + "_least", d.least, "least change of volume", "of these"}});
}

Figures levelFigures(const MapSolve& solve) {
  const auto level = [](const AdaptiveLevel& l) -> Figures {
    return {{"level_distances", l.distance, "levels' distances", "of charges from the surface",
             kDiagonals},
            {"level_sources", l.sources, "levels' charges", ""}};
  };
  const auto round = [](const AdaptiveRound& r) -> Figures {
    return {
        {"round_sources", r.sources, "rounds' charges", ""},
        {"round_p99", r.error.p99, "rounds' errors", "99% within, after each round", kDiagonals}};
  };
  return when(!solve.levels.empty(),
              together({columns(solve.levels, level), columns(solve.rounds, round)}));
}

Figures trialFigures(const MapSolve& solve) {
  const auto trial = [](const DistanceTrial& t) -> Figures {
    return {{"tried_distances", t.distance, "distances tried", "", kDiagonals},
            {"tried_errors", t.heldOutRms, "their errors", "at points kept out of the fit",
             kDiagonals}};
  };
  return when(!solve.trials.empty(), columns(solve.trials, trial));
}

}  // namespace

Figures figures(const BoundaryError& e) {
  return {
      {"rms", e.rms, "root mean square",
       "typical error at points of the surface that took no part in the fit", kDiagonals},
      {"p99", e.p99, "99% within", "99 of 100 of these points are nearer than this", kDiagonals},
      {"max", e.max, "largest", "the largest that was found", kDiagonals},
      {"samples", e.samples, "points", "at which it was measured"}};
}

Figures boundaryErrorFigures(const MapFit* fit) {
  const BoundaryError none, &e = fit ? fit->error : none;
  const std::optional<double> unknown;
  return together(
      {figures(e),
       {sumOfSquares(fit ? fit->collocationError : 0)},
       {{"vertices_rms", fit ? fit->verticesRms : unknown, "at vertices left out",
         "root mean square at vertices that the fit never saw", kDiagonals}},
       boundFigures(e.p99Bound, e.bound),
       {{"searched", e.searched, "evaluations", "spent on the search for the largest error"},
        {"vertices_max", fit ? fit->verticesMax : unknown, "largest at vertices", "at any vertex",
         kDiagonals},
        {"triangles", fit ? fit->triangles : unknown, "triangles' error",
         "how far the flat triangles are from a smooth surface through the vertices", kDiagonals},
        {"smooth_bound", fit ? fit->smoothBound : 0, "bound against a smooth surface",
         "the bound above and the triangles' error together", kDiagonals}}});
}

Figures boundaryErrorFigures(const HarmonicFit& fit) {
  return together({figures(fit.error),
                   {sumOfSquares(fit.error.sumOfSquares)},
                   boundFigures(fit.error.p99Bound, fit.bound)});
}

namespace {

Figures toleranceFigures(double wanted, double reached, bool met) {
  return {{"wanted", wanted, "wanted", "99% of the boundary should lie within this", kDiagonals},
          {"reached", reached, "reached", "99% lies within this", kDiagonals},
          {"met", met, "met", "whether it does"}};
}

}  // namespace

Figures toleranceFigures(const MapFit* fit, const std::string& ended) {
  const BoundaryError none, &error = fit ? fit->error : none;
  const ToleranceOutcome t = fit && fit->tolerance ? *fit->tolerance : ToleranceOutcome{};
  return together(
      {toleranceFigures(t.wanted, t.reached, t.met),
       when(!t.met,
            {{"ended", ended, "why no more", "why the fit ended before it was met"},
             {"missed", error.missed, "missed", "of the boundary, where it is not met", kShare},
             {"worst_at", error.maxAt, "largest error's place", "x, y, z in the source",
              FigureUnit::length}})});
}

Figures toleranceFigures(const HarmonicFit& fit, double wanted) {
  return toleranceFigures(wanted, fit.error.p99, fit.met);
}

Figures figures(const MapSolve& s) {
  const bool adaptive = !s.levels.empty();
  const bool iterative = adaptive || s.method == SolveMethod::iterative;
  return together(
      {{{"method", wordOf(s.method), "method", "adaptive, iterative, tikhonov, tsvd or dense"},
        {"sources", s.sources, "charges", ""},
        {"collocation", s.collocation, "points fitted", "of the boundary"},
        {"rank", s.rank, "rank", "combinations of charges that are used"},
        {"regularization", s.regularization, "regularisation", "relative; 0: none is needed"},
        {"iterations", s.iterations, "iterations", ""},
        {"placement", wordOf(s.placement), "placement", "of the charges: adaptive, shell, sphere"},
        Figure("radius_ratio", s.radiusRatio, "sphere's radius", "in half diagonals")
            .when(s.radiusRatio > 0),
        Figure("distance", s.distance, "distance", "of the farthest charges from the surface",
               kDiagonals)
            .when(!(s.radiusRatio > 0) && s.distance > 0)},
       levelFigures(s),
       when(iterative,
            {{"residuals", s.residuals, "residuals", "rms at the points fitted, by iteration"},
             {"product_error", s.productError, "error of the fast sums", "relative"}}),
       {Figure("condition", s.condition, "condition", "of the system").when(!iterative),
        {"weight_norm", s.weightNorm, "size of the weights",
         "large weights cancel one another and lose digits"},
        Figure("held_out", s.heldOut, "points held out", "that chose settings, and were not fitted")
            .when(!adaptive)},
       trialFigures(s)});
}

Figures solveFigures(const HarmonicFit& fit) {
  MapSolve solve;
  solve.sources = solve.rank = fit.sources;
  solve.collocation = fit.collocation;
  return only(figures(solve),
              {"method", "sources", "collocation", "rank", "regularization", "iterations"});
}

Figures choiceFigures(std::uint64_t seed, std::optional<bool> smooth) {
  return {Figure("interpolation", std::string(smooth.value_or(false) ? "smooth" : "linear"),
                 "between vertices", "linear: as flat triangles; smooth: as a smooth deformation")
              .when(smooth.has_value()),
          {"seed", seed, "seed", "of all random points"}};
}

Figures figures(const InsideFigures& inside) {
  const double samples = static_cast<double>(std::max<std::size_t>(1, inside.samples));
  return {
      {"samples", inside.samples, "points", "that were looked at"},
      {"folded", inside.folded, "folded", "share of these that the map turns inside out", kShare},
      {"folded_at_overlap", static_cast<double>(inside.determinants.foldedAtOverlap) / samples,
       "folded at overlaps", "share of them folded where the target runs through itself", kShare},
      {"outside", inside.outside, "outside",
       "share that lands outside the target by more than the error of 99% of the boundary", kShare},
      {"folded_at", inside.foldedAt, "folded places", "x, y, z of the first, in the source",
       FigureUnit::length}};
}

Figures stepFigures(const std::vector<MapStep>& steps) {
  const auto step = [](const MapStep& s) -> Figures {
    return {{"to", s.to, "parts of the way", "where each step ends"},
            {"sources", s.sources, "steps' charges", ""},
            {"p99", s.error, "steps' errors", "99% within", kDiagonals},
            {"folded", s.folded, "folded by steps", "of the points inside", kShare}};
  };
  return together(
      {{{"count", std::max<std::size_t>(1, steps.size()), "steps", "1: one harmonic map"}},
       when(!steps.empty(), columns(steps, step))});
}

// Of cells that are folded, then undecided, the largest first.
Points unprovenPlaces(const ProofFigures& proof) {
  constexpr std::size_t kMost = 16;
  Points out;
  for (const std::vector<ProofCell>* cells : {&proof.negativeCells, &proof.undecidedCells})
    for (const ProofCell& cell : *cells)
      if (out.size() < kMost) out.push_back(cell.center);
  return out;
}

Figures figures(const ProofFigures& proof) {
  const Points places = unprovenPlaces(proof);
  return {
      {"proof_cells", proof.cells, "cells of the proof", "that cover the solid"},
      {"proof_undecided", proof.undecided, "cells undecided", "of which nothing is proven"},
      {"proof_negative", proof.negative, "cells folded", "everywhere, proven"},
      {"proof_proven_share", proof.proven, "proven", "not folded, share of the volume, at least",
       kShare},
      {"proof_undecided_share", proof.undecidedShare, "undecided", "share of the volume, at most",
       kShare},
      {"proof_negative_share", proof.negativeShare, "proven folded", "share of the volume, at most",
       kShare},
      {"proof_mirrored", proof.mirrored, "mirrored", "the map swaps left and right everywhere"},
      {"proof_least", proof.least, "least det J", "its size where its sign is proven, at least"},
      Figure("proof_boundary_error", proof.boundaryError, "boundary error, proven",
             "no point of the boundary is farther off", kDiagonals)
          .when(proof.boundaryError > 0),
      Figure("proof_one_to_one", proof.oneToOne, "one-to-one, proven",
             "1: no two points of the solid go to one; 0: not decided")
          .when(proof.oneToOne >= 0),
      Figure("proof_places", places, "cells not proven",
             "x, y, z of the first, in the source; of the run that proved alone",
             FigureUnit::length)
          .when(!places.empty())};
}

Figures figures(const Verification& made) {
  const auto row = [](const Claim& claim) -> Figures {
    return {{"claims", claim.name, "claims", "a name each"},
            {"claimed", claim.claimed, "claimed", "in words"},
            {"found", claim.found, "found", "in words"},
            {"results", wordOf(claim.result), "results",
             "of each claim: holds, fails or cannot be shown"}};
  };
  Points places;
  for (const Claim& claim : made.claims)
    if (claim.result != ClaimResult::holds)
      places.insert(places.end(), claim.places.begin(), claim.places.end());
  return together(
      {{{"any", !made.claims.empty(), "claims anything", "to be proven"},
        {"holds", made.holds(), "holds", "each claim"}},
       columns(made.claims, row),
       {Figure("places", places, "places", "x, y, z where claims do not hold", FigureUnit::length)
            .when(!places.empty())},
       under("proven", "proven again", when(made.found.cells > 0, figures(made.found)))});
}

Figures figures(const Injectivity& known) {
  const DegreeFigures& degree = known.degree;
  return together(
      {{{"statement", injectivityStatement(known), "in words",
         "what innermap checked, what it found and what follows"},
        {"parts", known.solid.parts, "parts", "of the solid, not connected with one another"},
        {"surfaces", known.solid.surfaces, "closed surfaces",
         "that bound it: one of each part and each cavity"}},
       determinantFigures("inside", "points inside", "that were checked", known.inside),
       {Figure("outside", known.outside, "outside",
               "share of the points inside that land outside the target by more than the boundary "
               "error",
               kShare)
            .when(known.inside.checked > 0)},
       determinantFigures("boundary", "points of the boundary", "that were checked",
                          known.boundary),
       {Figure("boundary_error", known.boundaryError, "boundary error", "of 99% of it", kDiagonals)
            .when(known.boundaryError > 0)},
       when(degree.checked > 0,
            {{"degree_checked", degree.checked, "places deep inside",
              "about which innermap counted how often the boundary's image winds"},
             {"degree_least", degree.least, "least winding",
              "1 where the boundary goes round once, as it should"},
             {"degree_greatest", degree.greatest, "greatest winding",
              "1 where the boundary goes round once, as it should"}}),
       determinantFigures("voxels", "voxels", "that were checked, by their centres, after repair",
                          known.voxels),
       {Figure("repaired", known.repaired, "repaired", "voxels that were folded before")
            .when(known.voxels.checked > 0)},
       determinantFigures("cells", "cells between voxels", "tetrahedra on which the map is linear",
                          known.cells),
       {Figure("cells_share", known.cells.share, "cells' share",
               "of the solid's volume that they fill", kShare)
            .when(known.cells.checked > 0),
        Figure("cells_overlaps", known.cells.overlaps, "cells' overlaps",
               "places where the image of their boundary runs through itself")
            .when(known.cells.overlaps >= 0),
        Figure("cells_exact", known.cells.exact, "cells decided exactly",
               "whose sign rounding might have turned")
            .when(known.cells.checked > 0)},
       when(known.proof.cells > 0, figures(known.proof)),
       {{"source_crossings_at", known.source.places, "source's crossings", "x, y, z of the first",
         FigureUnit::length},
        {"target_crossings_at", known.target.places, "target's crossings", "x, y, z of the first",
         FigureUnit::length}}});
}

Figures fieldFigures(double span, double freeShare) {
  return {{"span", span, "values' span", "the largest of a channel: errors are fractions of it"},
          {"free_share", freeShare, "free surface", "where the flux is given", kShare}};
}

Figures energyFigures(const MapGrids& g) {
  return {{"harmonic", g.harmonicTotal, "harmonic",
           "how much the map changes from place to place, both solids of volume 1; 3 for a rigid "
           "motion"},
          {"deformation", g.deformationTotal, "deformation",
           "what the deformation would cost rubber; 0 for a rigid motion"},
          {"deformation_mean", g.volume > 0 ? g.deformationTotal / g.volume : 0.0,
           "deformation, mean", "of a unit of volume"}};
}

Figures figures(const LameConstants& lame) {
  return {{"lame_lambda", lame.lambda, "λ", "Lamé's first constant, as used"},
          {"lame_mu", lame.mu, "μ", "Lamé's second constant, as used"}};
}

Figures jacobianFigures(const MapGrids& g) {
  return {{"min", g.jacobianMin, "least", "0 or less: folded there"},
          {"max", g.jacobianMax, "greatest", "grows by this factor there"},
          {"folded_fraction", g.foldedFraction, "folded",
           "share of the volume that the map turned inside out, before repair", kShare}};
}

Figures repairFigures(const MapGrids& g) {
  return {{"folded_voxels", g.foldedVoxels, "folded voxels", "before"},
          {"left", g.foldedVoxelsLeft, "left", "folded voxels that could not be repaired"},
          {"farthest", g.repairedFarthest, "farthest", "that a repair moved a voxel's image",
           kDiagonals}};
}

Figures gridFigures(double voxelSize, std::uint64_t activeVoxels, std::uint64_t interiorVoxels) {
  return {{"voxel_size", voxelSize, "voxel size", "", FigureUnit::length},
          {"active_voxels", activeVoxels, "voxels", "with values, skin included"},
          {"interior_voxels", interiorVoxels, "voxels inside", "with their centre inside"}};
}

Figures gridFigures(const SolidGrids& g) {
  return together(
      {gridFigures(g.voxelSize, g.values.activeVoxels, g.values.interiorVoxels),
       {{"volume", g.values.volume, "volume", "of the solid as the grid has it",
         FigureUnit::volume},
        {"map_rounding", g.mapRounding, "rounding", "of positions by storing floats", kDiagonals},
        Figure("map_local_origin", g.localOrigin, "local map's origin", "x, y, z",
               FigureUnit::length)
            .when(g.mapLocal != nullptr)}});
}

}  // namespace innermap
