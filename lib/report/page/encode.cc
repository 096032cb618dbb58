#include "report/page/encode.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <sstream>

#include "core/base64.h"

namespace innermap {
namespace {

std::string compressed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 6) != Z_OK)
    throw std::bad_alloc();  // all that can fail here
  out.resize(size);
  return out;
}

std::string base64(const std::string& bytes) {
  std::ostringstream out;
  Base64Writer(out).addBytes(bytes);
  return out.str();
}

template <class Number>
std::string encodedAs(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  Number before = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto step = static_cast<Number>(numbers[i] - before);
    before = numbers[i];
    for (std::size_t k = 0; k < sizeof(Number); ++k)
      bytes[k * numbers.size() + i] = static_cast<char>((step >> (8 * k)) & 255u);
  }
  return base64(compressed(bytes));
}

}  // namespace

std::string encoded(const std::vector<std::uint16_t>& numbers) { return encodedAs(numbers); }
std::string encoded(const std::vector<std::uint32_t>& numbers) { return encodedAs(numbers); }

template <class Number>
Quantised quantised(const std::vector<Number>& values) {
  constexpr double kDecades = 1e3, kSteps = 65534;
  Quantised out;
  std::vector<std::uint16_t> codes(values.size(), 0);
  double least = std::numeric_limits<double>::infinity(), greatest = -least, positive = least;
  for (const Number value : values) {
    if (!std::isfinite(value)) continue;
    least = std::min<double>(least, value);
    greatest = std::max<double>(greatest, value);
    if (value > 0) positive = std::min<double>(positive, value);
  }
  if (!(least <= greatest)) {
    out.codes = encoded(codes);
    return out;
  }
  out.logarithmic = least >= 0 && greatest > kDecades * positive;
  // What is 0, or all but 0, is as good as the least that is shown.
  if (out.logarithmic) least = std::max({least, positive, 1e-9 * greatest});
  out.least = least;
  out.greatest = greatest;
  const auto scale = [&](double v) { return out.logarithmic ? std::log(std::max(v, least)) : v; };
  const double from = scale(least), width = scale(greatest) - from;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const double share = width > 0 ? std::clamp((scale(values[i]) - from) / width, 0.0, 1.0) : 0;
    codes[i] = static_cast<std::uint16_t>(1 + std::lround(kSteps * share));
  }
  out.codes = encoded(codes);
  return out;
}

template Quantised quantised(const std::vector<float>& values);
template Quantised quantised(const std::vector<double>& values);

}  // namespace innermap
