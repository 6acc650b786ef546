// Sums over the passes of a room, for all pixels or for some of them, in an order that does not depend on who made
// which pass.
#pragma once
#include "compute/room_tracer.hpp"
#include "render/pixel_statistics.hpp"
#include "render/room_eye.hpp"

namespace greenray {

struct RoomTally {
  PixelStatistics pixels;
  std::vector<float> sums;  // of depth, bend and photon count: [3][pixels]
  PhotonTotals photons;

  RoomTally(std::size_t pixel_count, std::size_t waves) : pixels(pixel_count, waves), sums(3 * pixel_count) {}
  int passes() const { return pixels.passes(); }
  /// One pass over these pixels.
  void add(const RoomPass &pass, const PhotonTotals &of_pass);
  /// Sums of passes that come later.
  void add(const RoomTally &later);
  /// Puts the sums of `part` in the place of pixels first, first + 1 ..., its passes and photons in place of these.
  void place(const RoomTally &part, std::size_t first);
  /// Those of pixels first .. last - 1.
  RoomTally part(std::size_t first, std::size_t last) const;
  void clear() { *this = RoomTally(pixels.pixels(), pixels.waves()); }

  /// Bytes that write() makes.
  std::size_t bytes() const {
    return pixels.state_size() * sizeof(double) + sums.size() * sizeof(float) + sizeof photons;
  }
  /// To a file or a letter: anything with add(values) for arrays. The counts must be told beside it.
  template <class Sink>
  void write(Sink &to) const {
    to.add(pixels.state());
    to.add(sums);
    to.add(std::vector<PhotonTotals>{photons});
  }
  /// errors: RunError when they are sums of another picture
  template <class Source>
  void read(Source &from) {
    std::vector<double> state;
    std::vector<PhotonTotals> totals;
    from.take(state, pixels.state_size()), from.take(sums, 3 * pixels.pixels()), from.take(totals, 1);
    pixels.restore(state);
    photons = totals.front();
  }
};

/// Pixels first .. last - 1 of a pass.
RoomPass part_of(const RoomPass &pass, std::size_t first, std::size_t last, std::size_t waves);

/* The sums of a picture with many passes are made in blocks: those of a block in the order of its passes, then the
   blocks in their order. Blocks can so be made apart and put together to the same bits. Few passes: a block each, so
   that this is the plain sum. */
class BlockedTally {
 public:
  BlockedTally(std::size_t pixels, std::size_t waves, int block_passes)
      : whole_(pixels, waves), block_(block_passes > 1 ? pixels : 0, waves), block_passes_(block_passes) {}
  void add(const RoomPass &pass, const PhotonTotals &of_pass);
  /// The last block may have fewer passes.
  void end();
  int passes() const { return whole_.passes() + block_.passes(); }
  int block_passes() const { return block_passes_; }
  const RoomTally &whole() const { return whole_; }  // without the block that is being made
  void place(const BlockedTally &part, std::size_t first) {
    whole_.place(part.whole_, first);
    if (block_passes_ > 1) block_.place(part.block_, first);
  }
  template <class Sink>
  void write(Sink &to) const {
    whole_.write(to), block_.write(to);
  }
  template <class Source>
  void read(Source &from) {
    whole_.read(from), block_.read(from);
  }
  /// Of pixels first .. last - 1.
  BlockedTally part(std::size_t first, std::size_t last) const;

 private:
  RoomTally whole_, block_;
  int block_passes_;
};

}  // namespace greenray
