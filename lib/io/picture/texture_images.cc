#include <cmath>
#include <map>

#include "innermap/io/pictures.h"
#include "io/picture/detail/image.h"

namespace innermap {
namespace {

constexpr const char* kMark = "<UDIM>";
constexpr int kColumns = 10, kFirst = 1001;
constexpr double kMostRows = 1e6;  // far beyond all that have a name

std::string tilePath(std::string path, const UdimTile& tile) {
  const std::string number = std::to_string(kFirst + tile.first + kColumns * tile.second);
  return path.replace(path.find(kMark), std::string(kMark).size(), number);
}

}  // namespace

struct TextureImages::Data {
  bool tiled = false;
  std::map<UdimTile, Image> tiles;
  int width = 0, height = 0;
  std::string colourSpace, channels;
  std::vector<std::string> notes;

  void read(const std::string& path, const UdimTile& tile, Wrap wrap,
            const TextureImageSettings& settings) {
    ImageSettings image;
    image.colourSpace = settings.colourSpace;
    ImageFile file = readImage(path, image);
    for (const std::string& note : file.notes) notes.push_back(path + ": " + note);
    width = file.pixels.width;
    height = file.pixels.height;
    colourSpace = file.colourSpace;
    channels = file.channels;
    tiles.emplace(tile, Image(std::move(file.pixels), wrap));
  }
};

bool isTiled(const std::string& path) { return path.find(kMark) != std::string::npos; }

TextureImages::TextureImages(const std::string& path, const std::vector<UdimTile>& tiles,
                             const TextureImageSettings& settings) {
  auto data = std::make_shared<Data>();
  data->tiled = isTiled(path);
  if (!data->tiled) data->read(path, {0, 0}, settings.wrap, settings);
  if (data->tiled)
    for (const UdimTile& tile : tiles)
      data->read(tilePath(path, tile), tile, Wrap::clamp, settings);
  data_ = std::move(data);
}

Vec3 TextureImages::at(const Vec2& uv, const Vec2& a, const Vec2& b) const {
  if (!data_->tiled) return data_->tiles.begin()->second.at(uv, a, b);
  const double column = std::floor(uv.x), row = std::floor(uv.y);
  if (!(column >= 0 && column < kColumns && row >= 0 && row < kMostRows)) return {};
  const auto tile = data_->tiles.find({static_cast<int>(column), static_cast<int>(row)});
  if (tile == data_->tiles.end()) return {};
  return tile->second.at({uv.x - column, uv.y - row}, a, b);
}

int TextureImages::width() const { return data_->width; }
int TextureImages::height() const { return data_->height; }
const std::string& TextureImages::colourSpace() const { return data_->colourSpace; }
const std::string& TextureImages::channels() const { return data_->channels; }
std::size_t TextureImages::count() const { return data_->tiles.size(); }
const std::vector<std::string>& TextureImages::notes() const { return data_->notes; }

std::uint64_t textureImageMemory(const std::string& path, const std::vector<UdimTile>& tiles) {
  if (!isTiled(path)) return imageMemory(path);
  return tiles.empty() ? 0 : tiles.size() * imageMemory(tilePath(path, tiles.front()));
}

std::vector<Setting> describe(TextureImageSettings& s) {
  return {Setting("colour_space", "SPACE",
                  choiceOf<ColourSpace>(&s.colourSpace, {{"auto", ColourSpace::automatic},
                                                         {"linear", ColourSpace::linear},
                                                         {"srgb", ColourSpace::srgb}}),
                  "colour space of the image. auto: as the file says, else sRGB for 8 bits and "
                  "linear for more; vertex colours are linear unless you give srgb"),
          Setting("wrap", "WAY",
                  choiceOf<Wrap>(&s.wrap, {{"repeat", Wrap::repeat},
                                           {"clamp", Wrap::clamp},
                                           {"mirror", Wrap::mirror},
                                           {"black", Wrap::black}}),
                  "how the image continues beyond its borders")
              .rare()};
}

}  // namespace innermap
