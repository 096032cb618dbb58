#include "core/figure.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"

namespace innermap {
namespace {

struct ColumnOf {
  FigureValue operator()(const std::string&) const { return std::vector<std::string>(); }
  template <class Value>
  FigureValue operator()(const Value&) const {
    return std::vector<double>();
  }
};

struct FigureNumber {
  double operator()(double value) const { return value; }
  double operator()(bool value) const { return value ? 1 : 0; }
  template <class Value>
  double operator()(const Value& value) const {
    if constexpr (std::is_integral_v<Value>)
      return static_cast<double>(value);
    else
      throw Error("a figure that is no number stands for one");
  }
};

}  // namespace

std::string textOf(FigureUnit unit) {
  switch (unit) {
    case FigureUnit::none:
      break;
    case FigureUnit::share:
      return "share from 0 to 1";
    case FigureUnit::diagonals:
      return "fraction of the diagonal";
    case FigureUnit::length:
      return "world units";
    case FigureUnit::volume:
      return "world units cubed";
    case FigureUnit::degrees:
      return "degrees";
    case FigureUnit::seconds:
      return "seconds";
    case FigureUnit::bytes:
      return "bytes";
  }
  return "";
}

Figure Figure::when(bool is) const {
  Figure out = *this;
  out.known = known && is;
  return out;
}

std::vector<double> Figure::coordinates(const std::vector<Vec3>& places) {
  std::vector<double> out;
  for (const Vec3& p : places) out.insert(out.end(), {p.x, p.y, p.z});
  return out;
}

Figures together(std::initializer_list<Figures> parts) {
  Figures out;
  for (const Figures& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

Figures under(const std::string& key, const std::string& name, Figures figures) {
  for (Figure& f : figures) {
    f.key = key + "." + f.key;
    if (!name.empty()) f.name = name + ", " + f.name;
  }
  return figures;
}

Figures prefixed(const std::string& prefix, Figures figures) {
  for (Figure& f : figures) f.key = prefix + f.key;
  return figures;
}

Figures when(bool is, Figures figures) {
  for (Figure& f : figures) f.known = f.known && is;
  return figures;
}

Figures only(const Figures& figures, std::initializer_list<std::string_view> keys) {
  Figures out;
  for (const std::string_view key : keys) {
    const auto found =
        std::find_if(figures.begin(), figures.end(), [&](const Figure& f) { return f.key == key; });
    if (found == figures.end()) throw Error("no figure is called " + std::string(key));
    out.push_back(*found);
  }
  return out;
}

const Figure* findFigure(const Figures& figures, std::string_view key) {
  const auto found = std::find_if(figures.begin(), figures.end(),
                                  [&](const Figure& f) { return f.known && f.key == key; });
  return found == figures.end() ? nullptr : &*found;
}

double numberOf(const Figure& figure) {
  return figure.known ? std::visit(FigureNumber(), figure.value) : std::nan("");
}

Figures emptyColumns(const Figures& row) {
  Figures out = row;
  for (Figure& f : out) {
    f.value = std::visit(ColumnOf(), f.value);
    f.known = true;
  }
  return out;
}

void addRow(Figures& columns, const Figures& row) {
  if (columns.size() != row.size()) throw Error("the rows of a table have different figures");
  for (std::size_t i = 0; i < row.size(); ++i)
    if (auto* texts = std::get_if<std::vector<std::string>>(&columns[i].value))
      texts->push_back(row[i].known ? std::get<std::string>(row[i].value) : "");
    else
      std::get<std::vector<double>>(columns[i].value).push_back(numberOf(row[i]));
}

}  // namespace innermap
