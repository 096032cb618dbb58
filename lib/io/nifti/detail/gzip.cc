#include "io/nifti/detail/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kGzip = 15 + 16;  // zlib's largest window, gzip's header
constexpr std::size_t kPiece = std::size_t(1) << 20;

Bytef* bytesOf(const char* text) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(text));  // zlib only reads there
}

}  // namespace

bool isGzip(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
}

std::string unpacked(const std::string& path, std::string_view packed, std::uint64_t count) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  std::string out(count, '\0');
  std::uint64_t made = 0;
  std::size_t taken = 0;
  int status = Z_OK;
  while (made < count && status != Z_STREAM_END) {
    throwIfCancelled();
    if (stream.avail_in == 0) {
      const std::size_t piece = std::min(kPiece, packed.size() - taken);
      stream.next_in = bytesOf(packed.data() + taken);
      stream.avail_in = static_cast<uInt>(piece);
      taken += piece;
    }
    const auto room = static_cast<uInt>(std::min<std::uint64_t>(kPiece, count - made));
    stream.next_out = reinterpret_cast<Bytef*>(&out[made]);
    stream.avail_out = room;
    status = inflate(&stream, Z_NO_FLUSH);
    made += room - stream.avail_out;
    if (status == Z_BUF_ERROR && taken == packed.size()) break;  // cut short
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      throw FileError(path, "holds damaged gzip data; export the file again");
  }
  out.resize(made);
  return out;
}

struct GzipWriter::State {
  z_stream stream{};
  std::vector<char> out = std::vector<char>(kPiece);
};

GzipWriter::GzipWriter(std::ostream& stream) : stream_(stream), state_(std::make_unique<State>()) {
  if (deflateInit2(&state_->stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, 8,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

GzipWriter::~GzipWriter() { deflateEnd(&state_->stream); }

void GzipWriter::add(std::string_view bytes) {
  for (std::size_t at = 0; at < bytes.size(); at += kPiece)
    run(bytes.substr(at, kPiece), Z_NO_FLUSH);
}

void GzipWriter::finish() { run({}, Z_FINISH); }

void GzipWriter::run(std::string_view bytes, int flush) {
  z_stream& z = state_->stream;
  z.next_in = bytesOf(bytes.data());
  z.avail_in = static_cast<uInt>(bytes.size());
  do {
    z.next_out = reinterpret_cast<Bytef*>(state_->out.data());
    z.avail_out = static_cast<uInt>(state_->out.size());
    deflate(&z, flush);
    stream_.write(state_->out.data(),
                  static_cast<std::streamsize>(state_->out.size() - z.avail_out));
  } while (z.avail_out == 0);
}

}  // namespace innermap
