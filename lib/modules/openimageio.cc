// The module of io/picture/detail/image_library.h: all that innermap asks of OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <utility>

#include "io/picture/detail/image_library.h"

namespace innermap {
namespace {

ImageInfo infoOf(const OIIO::ImageSpec& spec) {
  ImageInfo info;
  info.deep = spec.deep;
  info.depth = spec.depth;
  info.fullDepth = spec.full_depth;
  info.x = spec.x;
  info.y = spec.y;
  info.width = spec.width;
  info.height = spec.height;
  info.fullX = spec.full_x;
  info.fullY = spec.full_y;
  info.fullWidth = spec.full_width;
  info.fullHeight = spec.full_height;
  info.channels = spec.channelnames;
  info.numberBytes = static_cast<int>(spec.format.basesize());
  info.colourSpace = std::string(spec.get_string_attribute("oiio:ColorSpace"));
  info.gamma = static_cast<double>(spec.get_float_attribute("oiio:Gamma", 0.0f));
  info.alphaIsDivided = spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
  return info;
}

class Reader final : public ImageReader {
 public:
  explicit Reader(std::unique_ptr<OIIO::ImageInput> input)
      : input_(std::move(input)), info_(infoOf(input_->spec())) {}

  const ImageInfo& info() const override { return info_; }

  bool read(int begin, int end, float* to, bool (*stop)(void*, float), void* with,
            std::string& error) override {
    const bool whole =
        input_->read_image(0, 0, begin, end, OIIO::TypeDesc::FLOAT, to, OIIO::AutoStride,
                           OIIO::AutoStride, OIIO::AutoStride, stop, with);
    const bool good = whole && !input_->has_error();
    if (!good) error = input_->geterror();
    return good;
  }

 private:
  std::unique_ptr<OIIO::ImageInput> input_;
  ImageInfo info_;
};

class Library final : public ImageLibrary {
 public:
  std::unique_ptr<ImageReader> open(const std::string& path, const std::string& format,
                                    std::string& error) const override {
    std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(format);
    if (!input) {
      error = OIIO::geterror();
      return nullptr;
    }
    OIIO::ImageSpec wanted, found;
    wanted.attribute("oiio:UnassociatedAlpha", 1);
    if (!input->open(path, found, wanted)) {
      error = input->geterror();
      return nullptr;
    }
    return std::make_unique<Reader>(std::move(input));
  }

  std::vector<unsigned char> encodePng(int width, int height, const unsigned char* rgb,
                                       std::string& error) const override {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    OIIO::Filesystem::IOProxy* proxy = &memory;
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const std::unique_ptr<OIIO::ImageOutput> output =
        OIIO::ImageOutput::create("memory.png", &memory);
    if (!output || !output->open("memory.png", spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, rgb) || !output->close()) {
      error = output ? output->geterror() : OIIO::geterror();
      return {};
    }
    return bytes;
  }

  void drawText(int width, int height, float* rgb, int x, int y, const std::string& text, int size,
                const std::string& font, const std::array<float, 3>& colour) const override {
    OIIO::ImageBuf buffer(OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::FLOAT), rgb);
    OIIO::ImageBufAlgo::render_text(buffer, x, y, text, size, font, colour);
  }

  int textWidth(const std::string& text, int size, const std::string& font) const override {
    const OIIO::ROI roi = OIIO::ImageBufAlgo::text_size(text, size, font);
    return roi.defined() ? roi.xend : -1;
  }
};

}  // namespace
}  // namespace innermap

extern "C" [[gnu::visibility("default")]] const innermap::ImageLibrary* innermapImageLibrary() {
  static const innermap::Library library;
  return &library;
}
