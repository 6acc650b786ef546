// Peer of `greenray bench geometry`: rtcIntersect1 of Embree 3 on so many threads.
#include <embree3/rtcore.h>

#include <cstring>

#include "bench/geometry_suite.hpp"
#include "bench/race.hpp"

namespace greenray::bench {
namespace {

class EmbreeScene : public SegmentPeer {
 public:
  EmbreeScene(const Surfaces &surfaces, unsigned threads) : threads_(threads) {
    device_ = rtcNewDevice(nullptr);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const std::size_t count = surfaces.triangles.size();
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *corners = static_cast<float *>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * count));
    auto *indices = static_cast<unsigned *>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), count));
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        indices[3 * i + c] = static_cast<unsigned>(3 * i + c);
        for (std::size_t a = 0; a < 3; ++a)
          corners[9 * i + 3 * c + a] = static_cast<float>(surfaces.triangles[i].corner[c][a]);
      }
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene_);
  }
  ~EmbreeScene() override { rtcReleaseScene(scene_), rtcReleaseDevice(device_); }
  EmbreeScene(const EmbreeScene &) = delete;
  EmbreeScene &operator=(const EmbreeScene &) = delete;

  void find(std::span<const surface32::Segment> segments, std::span<surface32::SegmentHit> hits) override {
    on_threads(segments.size(), 4096, threads_, [&](std::size_t first, std::size_t last) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      for (std::size_t i = first; i < last; ++i) {
        const surface32::Segment &s = segments[i];
        RTCRayHit ray{};
        ray.ray.org_x = s.place[0], ray.ray.org_y = s.place[1], ray.ray.org_z = s.place[2];
        ray.ray.dir_x = s.direction[0], ray.ray.dir_y = s.direction[1], ray.ray.dir_z = s.direction[2];
        ray.ray.tfar = 1, ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &ray);
        const bool met = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        hits[i] = {ray.ray.tfar, ray.hit.u, ray.hit.v, met ? static_cast<int>(ray.hit.primID) : -1};
      }
    });
  }
  std::string version() const override { return RTC_VERSION_STRING; }

 private:
  unsigned threads_;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

std::unique_ptr<SegmentPeer> embree_peer(const Surfaces &surfaces, unsigned threads) {
  return std::make_unique<EmbreeScene>(surfaces, threads);
}

}  // namespace greenray::bench
