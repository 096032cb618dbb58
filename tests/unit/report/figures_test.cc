#include "report/figures.h"

#include <gtest/gtest.h>

#include <set>

#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_map.h"
#include "innermap/transfer/carry.h"
#include "report/report_sections.h"

namespace innermap {
namespace {

double numberAt(const Figures& figures, const char* key) {
  const Figure* found = findFigure(figures, key);
  return found ? numberOf(*found) : -1;
}

TEST(ResultFigures, HaveKeysOfTheirOwnAndNames) {
  // Sections of several commands have each key once, whatever their figures have.
  std::vector<Figures> lists{figures(MapSolve{}),           figures(Injectivity{}),
                             figures(BoundaryError{}),      boundaryErrorFigures(nullptr),
                             toleranceFigures(nullptr, ""), correspondenceFigures(nullptr),
                             gridFigures(SolidGrids{})};
  for (const ReportSection& section : reportSections()) lists.push_back(section.figures);
  for (const Figures& all : lists) {
    std::set<std::string> keys;
    for (const Figure& f : all) {
      EXPECT_TRUE(keys.insert(f.key).second) << f.key;
      EXPECT_EQ(f.key.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_.*"),
                std::string::npos)
          << f.key;
      EXPECT_FALSE(f.name.empty()) << f.key;
    }
  }
}

TEST(ResultFigures, OfASolveAreThoseOfItsMethod) {
  MapSolve dense{.method = SolveMethod::truncatedSvd, .distance = 0.1, .condition = 1e6};
  EXPECT_EQ(numberAt(figures(dense), "condition"), 1e6);
  EXPECT_EQ(numberAt(figures(dense), "distance"), 0.1);
  EXPECT_EQ(findFigure(figures(dense), "residuals"), nullptr);
  EXPECT_EQ(findFigure(figures(dense), "radius_ratio"), nullptr);
  MapSolve adaptive{.levels = {{0.1, 0.2, 50}, {0.05, 0.1, 70}}};
  const Figure* sources = nullptr;
  const Figures of = figures(adaptive);
  sources = findFigure(of, "level_sources");
  ASSERT_NE(sources, nullptr);
  EXPECT_EQ(std::get<std::vector<double>>(sources->value), (std::vector<double>{50, 70}));
  EXPECT_EQ(findFigure(of, "condition"), nullptr);
}

TEST(ResultFigures, OfWhatWasNotCheckedAreNotKnown) {
  Injectivity known;
  EXPECT_EQ(findFigure(figures(known), "inside_checked"), nullptr);
  known.inside.add(0.5);
  known.inside.add(-0.5);
  EXPECT_EQ(numberAt(figures(known), "inside_checked"), 2);
  EXPECT_EQ(numberAt(figures(known), "inside_folded"), 1);
  EXPECT_EQ(findFigure(figures(known), "cells_checked"), nullptr);
}

TEST(ResultFigures, OfADensityBeginWithItsName) {
  CarriedMass mass{.name = "smoke", .before = 2};
  EXPECT_EQ(numberAt(massFigures(mass), "smoke_before"), 2);
  EXPECT_EQ(numberAt(densityFigures(mass), "smoke_cells"), 0);
}

}  // namespace
}  // namespace innermap
