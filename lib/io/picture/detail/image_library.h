// What reads, writes and letters pictures: OpenImageIO, in a module that is loaded when it is first
// asked for. OpenImageIO brings over 200 shared libraries (Debian's among them video codecs), which
// take longer to load than most commands take to run; a process without pictures never loads them.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace innermap {

// A picture as its file describes it.
struct ImageInfo {
  bool deep = false;
  int depth = 1, fullDepth = 1;
  int x = 0, y = 0, width = 0, height = 0;                  // of the pixels that the file has
  int fullX = 0, fullY = 0, fullWidth = 0, fullHeight = 0;  // of what is to be seen
  std::vector<std::string> channels;
  int numberBytes = 1;          // of one number in the file
  std::string colourSpace;      // empty: not said
  double gamma = 0;             // 0: not said
  bool alphaIsDivided = false;  // colours are not multiplied by alpha
};

// An open picture.
class ImageReader {
 public:
  virtual ~ImageReader() = default;
  virtual const ImageInfo& info() const = 0;
  // Channels [begin, end) of all pixels, rows from the top: #height * #width * (end - begin). Calls
  // stop(with, share done) now and then. False where it failed, with the reason in `error`, or
  // where stop returned true.
  virtual bool read(int begin, int end, float* to, bool (*stop)(void* with, float done), void* with,
                    std::string& error) = 0;
};

class ImageLibrary {
 public:
  virtual ~ImageLibrary() = default;
  // format: OpenImageIO's name of it, such as "png". Empty, with the reason in `error`, where it
  // cannot be read.
  virtual std::unique_ptr<ImageReader> open(const std::string& path, const std::string& format,
                                            std::string& error) const = 0;
  // 8 bits a channel, sRGB; `rgb`: #height * #width * 3. No bytes, with the reason in `error`,
  // where it fails.
  virtual std::vector<unsigned char> encodePng(int width, int height, const unsigned char* rgb,
                                               std::string& error) const = 0;
  // Draws a line of text with its baseline at y on #height * #width * 3 floats.
  virtual void drawText(int width, int height, float* rgb, int x, int y, const std::string& text,
                        int size, const std::string& font,
                        const std::array<float, 3>& colour) const = 0;
  // Pixels; -1 where the font cannot be used.
  virtual int textWidth(const std::string& text, int size, const std::string& font) const = 0;
};

// Loads the module at the first call. Throws Error where it is missing or of another version.
const ImageLibrary& imageLibrary();

}  // namespace innermap
