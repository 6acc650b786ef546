#include "render/room_tally.hpp"

#include <algorithm>

#include "support/error.hpp"

namespace greenray {

void RoomTally::add(const RoomPass &pass, const PhotonTotals &of_pass) {
  pixels.add({pass.radiance, pass.narrower, pass.variance});
  std::size_t i = 0;
  for (const std::vector<float> *values : {&pass.depth_m, &pass.bend_mrad, &pass.photon_count})
    for (const float value : *values) sums[i++] += value;
  photons.add(of_pass);
}

void RoomTally::add(const RoomTally &later) {
  pixels.add(later.pixels);
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += later.sums[i];
  photons.add(later.photons);
}

void RoomTally::place(const RoomTally &part, std::size_t first) {
  pixels.place(part.pixels, first);
  const std::size_t all = pixels.pixels(), some = part.pixels.pixels();
  for (std::size_t k = 0; k < 3; ++k)
    std::copy_n(part.sums.begin() + static_cast<std::ptrdiff_t>(k * some), some,
                sums.begin() + static_cast<std::ptrdiff_t>(k * all + first));
  photons = part.photons;
}

RoomTally RoomTally::part(std::size_t first, std::size_t last) const {
  RoomTally out(last - first, pixels.waves());
  out.pixels = pixels.part(first, last);
  const std::size_t all = pixels.pixels();
  for (std::size_t k = 0; k < 3; ++k)
    std::copy_n(sums.begin() + static_cast<std::ptrdiff_t>(k * all + first), last - first,
                out.sums.begin() + static_cast<std::ptrdiff_t>(k * (last - first)));
  out.photons = photons;
  return out;
}

RoomPass part_of(const RoomPass &pass, std::size_t first, std::size_t last, std::size_t waves) {
  const auto some = [&](const std::vector<float> &values, std::size_t each) {
    return std::vector<float>(values.begin() + static_cast<std::ptrdiff_t>(first * each),
                              values.begin() + static_cast<std::ptrdiff_t>(last * each));
  };
  RoomPass out;
  out.radiance = some(pass.radiance, waves);
  out.narrower = some(pass.narrower, 1), out.variance = some(pass.variance, 1);
  out.depth_m = some(pass.depth_m, 1), out.bend_mrad = some(pass.bend_mrad, 1);
  out.photon_count = some(pass.photon_count, 1);
  return out;
}

void BlockedTally::add(const RoomPass &pass, const PhotonTotals &of_pass) {
  if (block_passes_ <= 1) return whole_.add(pass, of_pass);
  block_.add(pass, of_pass);
  if (block_.passes() == block_passes_) end();
}

void BlockedTally::end() {
  if (block_.passes() == 0) return;
  whole_.add(block_);
  block_.clear();
}

BlockedTally BlockedTally::part(std::size_t first, std::size_t last) const {
  BlockedTally out(0, whole_.pixels.waves(), block_passes_);
  out.whole_ = whole_.part(first, last);
  if (block_passes_ > 1) out.block_ = block_.part(first, last);
  return out;
}

}  // namespace greenray
