// Expansions in balls: which charges enter, up to which order, and what is cut off.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "proof/detail/lane_kernels.h"
#include "proof/detail/step_expansion.h"

namespace innermap::proof {

struct ExpansionBall {
  Vec3 center;
  double radius = 0;
};

// A charge w at distance d of a ball of radius ratio d leaves out, expanded to order p,
// |w| / d^2 ratio^p ((p+1) - p ratio) / (1 - ratio)^2 of the gradient at most. Charges up to the
// ratio `farRatio` enter a ball's expansion, each to the least of kOrders for which what follows
// |w| / d^2 is at most a tenth of that for order kOrder at farRatio; else to order kOrder.
OrderLimits orderLimits(double farRatio);

// Those that are far from a ball. places: memory for that.
void sortCharges(const double* charges, const std::vector<std::uint32_t>& some,
                 const ExpansionBall& ball, const OrderLimits& limits,
                 std::vector<std::int32_t>& places, OrderedCharges& out);

// An expansion's degrees up to `order` moved to a ball within its own, and charges added; all but
// the list of near ones.
void expandAbout(const double* charges, const StepExpansion& from, int order,
                 const OrderedCharges& added, const ExpansionBall& ball, StepExpansion& out);

// The degree up to which an expansion is worth moving to sets in a ball: the higher ones, which are
// added to the remainder, are small beside degree 2.
int worthyOrder(const StepExpansion& from, const ExpansionBall& ball, Remainder& rest);

// Adds what an expansion about another centre brings along when it is moved without what is cut.
void addInherited(const StepExpansion& from, const Remainder& cut, const LaneSets& sets,
                  LaneRemainders& remainders);

}  // namespace innermap::proof
