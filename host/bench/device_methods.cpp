#include "bench/device_methods.hpp"

#include <cmath>
#include <sstream>

#include "atmosphere/layer_table.hpp"
#include "compute/layer_tracer.hpp"
#include "compute/ray_tracer.hpp"

namespace greenray::bench {
namespace {

class DeviceRunner : public Runner {
 public:
  DeviceRunner(const std::shared_ptr<Device> &device, const IndexTable &table, const TraceOptions &options,
               std::span<const f64::RayStart> starts)
      : tracer_(device, table, options), starts_(starts.begin(), starts.end()) {
    (void)tracer_.trace(std::span(starts_).first(1));  // compiles
  }
  void run() override {
    const double before = tracer_.stats().device_seconds;
    ends_ = tracer_.trace(starts_);
    kernel_seconds_ = tracer_.stats().device_seconds - before;
  }
  Bent result(std::size_t ray) const override { return {ends_[ray].bending_rad, ends_[ray].outcome, ends_[ray].steps}; }
  double kernel_seconds() const override { return kernel_seconds_; }

 private:
  RayTracer tracer_;
  std::vector<f64::RayStart> starts_;
  std::vector<f64::RayEnd> ends_;
  double kernel_seconds_ = 0;
};

/// Layers in closed form: elevations of the starts, the index table as the fine truth below the layers.
template <class Scalar>
class LayerRunner : public Runner {
 public:
  LayerRunner(const std::shared_ptr<Device> &device, const IndexTable &table, double error_arcsec,
              std::span<const f64::RayStart> starts)
      : tracer_(device, layers_for(table, error_arcsec, starts),
                sizeof(Scalar) == sizeof(double) ? Precision::double_ : Precision::single_),
        rays_(tracer_, elevations_of(starts)) {
    rays_.run();  // compiles
  }
  void run() override { rays_.run(); }
  Bent result(std::size_t ray) const override { return {rays_.bending_rad(0)[ray], rays_.outcome(0, ray), 0}; }
  double kernel_seconds() const override { return rays_.kernel_seconds(); }

 private:
  static LayerTable layers_for(const IndexTable &table, double error_arcsec, std::span<const f64::RayStart> starts) {
    const double eye_m = table.cell(0, static_cast<std::size_t>(starts[0].cell)).bottom_m + starts[0].above_m;
    LayerTable layers = build_layer_table(table, place_layers(table, 0, eye_m, error_arcsec), eye_m, {});
    merge_far_layers(layers, table, {}, error_arcsec / 2, true);
    return layers;
  }
  static std::vector<double> elevations_of(std::span<const f64::RayStart> starts) {
    std::vector<double> elevations;
    for (const f64::RayStart &start : starts) elevations.push_back(std::atan2(start.rise, start.run));
    return elevations;
  }
  LayerTracer tracer_;
  BendBatch<Scalar> rays_;
};

void add_layers(std::vector<Method> &methods, const std::shared_ptr<Device> &device, Precision precision,
                const std::vector<double> &errors_arcsec) {
  const bool is_double = precision == Precision::double_;
  const int lanes = is_double ? device->lanes().lanes_double : device->lanes().lanes_float;
  for (double error_arcsec : errors_arcsec) {
    std::ostringstream words;
    words << "closed form " << (is_double ? "double" : "float") << " " << lanes << (lanes == 1 ? " lane" : " lanes")
          << ", layers " << error_arcsec << "\"";
    methods.push_back(
        {"", "", words.str(), device_words(*device), error_arcsec / 30, 0,
         [device, is_double, error_arcsec](const IndexTable &table,
                                           std::span<const f64::RayStart> starts) -> std::unique_ptr<Runner> {
           if (is_double) return std::make_unique<LayerRunner<double>>(device, table, error_arcsec, starts);
           return std::make_unique<LayerRunner<float>>(device, table, error_arcsec, starts);
         }});
  }
}

struct Point {
  double table_arcsec, tolerance_rad;
};

std::string words(const TraceOptions &o, int lanes, const Point &p) {
  std::ostringstream text;
  text << (o.integrator == Integrator::richardson ? "richardson" : "rk45") << " "
       << (o.precision == Precision::double_ ? "double" : "float") << " " << lanes
       << (lanes == 1 ? " lane " : " lanes ") << (o.storage == TableStorage::image ? "image" : "buffer") << ", table "
       << p.table_arcsec << "\", step " << p.tolerance_rad;
  return text.str();
}

void add(std::vector<Method> &methods, const std::shared_ptr<Device> &device, TraceOptions options,
         const std::vector<Point> &points) {
  options.with_columns = false;  // bending only, as the peers
  options.max_steps = 1000000;
  const bool is_double = options.precision == Precision::double_;
  const int lanes = is_double ? device->lanes().lanes_double : device->lanes().lanes_float;
  for (const Point &point : points) {
    TraceOptions at = options;
    at.tolerance_rad = point.tolerance_rad;
    methods.push_back({"", "", words(at, lanes, point), device_words(*device), point.table_arcsec, point.tolerance_rad,
                       [device, at](const IndexTable &table, std::span<const f64::RayStart> starts) {
                         return std::make_unique<DeviceRunner>(device, table, at, starts);
                       }});
  }
}

// Work-precision curves: table error and step tolerance loosened together, about in the proportion that measured best.
const std::vector<Point> rk_float{{3, 1e-5},    {1, 3e-6},    {0.3, 1e-6},   {0.1, 3e-7},
                                  {0.03, 1e-7}, {0.01, 3e-8}, {0.003, 1e-8}, {0.001, 1e-9}};
const std::vector<Point> rk_double{{1, 3e-6}, {0.1, 3e-7}, {0.01, 3e-8}, {0.001, 1e-9}, {1e-4, 1e-10}, {1e-6, 1e-12}};
const std::vector<Point> richardson_float{{1, 3e-6}, {0.1, 3e-7}, {0.01, 3e-8}, {0.003, 3e-9}};
const std::vector<Point> richardson_double{{0.01, 3e-8}, {0.001, 1e-9}};
const Point middle{0.01, 3e-8};

}  // namespace

std::string device_words(const Device &device) {
  const DeviceInfo &d = device.info();
  return d.address() + " " + d.name + " (" + d.platform_name + " " + d.driver + ")";
}

std::vector<Method> device_methods(const DeviceOptions &options, bool few) {
  const std::shared_ptr<Device> device = open_device(options);
  std::vector<Method> methods;
  const auto some = [&](const std::vector<Point> &points) { return few ? std::vector<Point>{middle} : points; };
  TraceOptions o;
  o.storage = TableStorage::buffer;
  add(methods, device, o, some(rk_float));
  if (!few && device->info().has_images) {
    TraceOptions image = o;
    image.storage = TableStorage::image;
    add(methods, device, image, {middle});
  }
  TraceOptions paper = o;
  paper.integrator = Integrator::richardson;
  add(methods, device, paper, some(richardson_float));
  TraceOptions fine = o, fine_paper = paper;
  fine.precision = fine_paper.precision = Precision::double_;
  if (device->info().has_double) {
    add(methods, device, fine, some(rk_double));
    if (!few) add(methods, device, fine_paper, richardson_double);
  }
  add_layers(methods, device, Precision::single_,
             few ? std::vector<double>{0.01} : std::vector<double>{0.3, 0.03, 0.01, 0.003, 0.001});
  if (device->info().has_double)
    add_layers(methods, device, Precision::double_,
               few ? std::vector<double>{0.01} : std::vector<double>{0.01, 1e-3, 1e-4, 1e-6});
  if (few || options.lanes || device->lanes().lanes_float == 1) return methods;
  DeviceOptions scalar = options;
  scalar.lanes = 1;
  const std::shared_ptr<Device> one_lane = open_device(scalar);
  add(methods, one_lane, o, {middle});
  add(methods, one_lane, paper, {middle});
  if (device->info().has_double) add(methods, one_lane, fine, {middle});
  return methods;
}

}  // namespace greenray::bench
