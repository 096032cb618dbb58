// Channels of an EXR file that is not trusted, as floats.
#pragma once

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "io/exr/detail/exr_stream.h"

namespace innermap {

class ExrReader {
 public:
  // Throws FileError, Cancelled.
  explicit ExrReader(const std::string& path);

  const std::string& path() const { return path_; }
  int parts() const { return file_->parts(); }
  const Imf::Header& header(int part) const { return file_->header(part); }
  int width(int part) const;
  int height(int part) const;

  // Throws FileError for what is no plain picture: deep samples, subsampled channels, pixels
  // cropped to a part of the picture; or that lacks one of the channels.
  void check(int part, const std::vector<std::string>& channels) const;

  // What OpenEXR allocates to read the part, bytes.
  std::uint64_t memory(int part) const;

  // Rows [begin, begin + count) of the channels: count * width floats to each of `outputs`. Parts
  // one after the other: the last one stays open. Throws FileError, Cancelled.
  void read(int part, int begin, int count, const std::vector<std::string>& channels,
            const std::vector<float*>& outputs);

 private:
  std::string path_;
  std::unique_ptr<ExrInputStream> stream_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  std::unique_ptr<Imf::InputPart> open_;
  int openPart_ = -1;
};

}  // namespace innermap
