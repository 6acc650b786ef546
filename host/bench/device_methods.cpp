#include "bench/device_methods.hpp"

#include <cmath>
#include <sstream>

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

/// The closed form on the device: bending and outcome alone, as the peers.
template <class Scalar>
class LayerRunner : public Runner {
 public:
  LayerRunner(const std::shared_ptr<Device> &device, const IndexTable &table, double error_arcsec,
              std::span<const f64::RayStart> starts)
      : waves_(table.wavelength_nm.size()),
        tracer_(device, layers_for(table, error_arcsec, starts),
                sizeof(Scalar) == sizeof(double) ? Precision::double_ : Precision::single_),
        rays_(tracer_, elevations_of(starts)) {
    rays_.run();  // compiles
  }
  void run() override { rays_.run(); }
  Bent result(std::size_t ray) const override {
    const std::size_t elevation = ray / waves_, wave = ray % waves_;
    return {rays_.bending_rad(wave)[elevation], rays_.outcome(wave, elevation), 0};
  }
  double kernel_seconds() const override { return rays_.kernel_seconds(); }

 private:
  std::size_t waves_;
  LayerTracer tracer_;
  BendBatch<Scalar> rays_;
};

int lanes_of(const Device &device, Precision precision) {
  return precision == Precision::double_ ? device.lanes().lanes_double : device.lanes().lanes_float;
}

Kind kind_of(const Device &device, const std::string &solver, Precision precision) {
  return {"", "", solver, precision == Precision::double_ ? "double" : "float", lanes_of(device, precision)};
}

/// "rk45 float 8 lanes"
std::string words(const Kind &k) {
  return k.solver + " " + k.precision + " " + std::to_string(k.lanes) + (k.lanes == 1 ? " lane" : " lanes");
}

struct Point {
  double table_arcsec, tolerance_rad;
};

Method stepping(const std::shared_ptr<Device> &device, TraceOptions options, const Point &point) {
  options.with_columns = false;  // bending only, as the peers
  options.max_steps = 1000000;
  options.tolerance_rad = point.tolerance_rad;
  const Kind kind =
      kind_of(*device, options.integrator == Integrator::richardson ? "richardson" : "rk45", options.precision);
  std::ostringstream text;
  text << words(kind) << (options.storage == TableStorage::image ? " image" : " buffer") << ", table "
       << point.table_arcsec << "\", step " << point.tolerance_rad;
  return {kind,
          text.str(),
          device_words(*device),
          point.table_arcsec,
          point.tolerance_rad,
          [device, options](const IndexTable &table, std::span<const f64::RayStart> starts) {
            return std::make_unique<DeviceRunner>(device, table, options, starts);
          }};
}

void add(std::vector<Method> &methods, const std::shared_ptr<Device> &device, const TraceOptions &options,
         const std::vector<Point> &points) {
  for (const Point &point : points) methods.push_back(stepping(device, options, point));
}

void add_layers(std::vector<Method> &methods, const std::shared_ptr<Device> &device, Precision precision,
                const std::vector<double> &errors_arcsec) {
  for (const double error : errors_arcsec) methods.push_back(closed_form_method(device, precision, error));
}

// Work-precision curves: table error and step tolerance loosened together, about in the proportion that measured best.
const std::vector<Point> rk_float{{3, 1e-5},    {1, 3e-6},    {0.3, 1e-6},   {0.1, 3e-7},
                                  {0.03, 1e-7}, {0.01, 3e-8}, {0.003, 1e-8}, {0.001, 1e-9}};
const std::vector<Point> rk_double{{1, 3e-6}, {0.1, 3e-7}, {0.01, 3e-8}, {0.001, 1e-9}, {1e-4, 1e-10}, {1e-6, 1e-12}};
const std::vector<Point> richardson_float{{1, 3e-6}, {0.1, 3e-7}, {0.01, 3e-8}, {0.003, 3e-9}};
const std::vector<Point> richardson_double{{0.01, 3e-8}, {0.001, 1e-9}};
const Point middle{0.01, 3e-8};

}  // namespace

LayerTable layers_for(const IndexTable &table, double error_arcsec, std::span<const f64::RayStart> starts) {
  const double eye_m = table.cell(0, static_cast<std::size_t>(starts[0].cell)).bottom_m + starts[0].above_m;
  LayerTable layers = build_layer_table(table, place_layers(table, 0, eye_m, error_arcsec), eye_m, {});
  merge_far_layers(layers, table, {}, error_arcsec / 2, true);
  return layers;
}

std::vector<double> elevations_of(std::span<const f64::RayStart> starts) {
  std::vector<double> elevations_rad;
  for (const f64::RayStart &start : starts)
    if (start.row == 0) elevations_rad.push_back(std::atan2(start.rise, start.run));
  return elevations_rad;
}

Method closed_form_method(const std::shared_ptr<Device> &device, Precision precision, double error_arcsec) {
  const Kind kind = kind_of(*device, "closed form", precision);
  std::ostringstream text;
  text << words(kind) << ", layers " << error_arcsec << "\"";
  return {kind,
          text.str(),
          device_words(*device),
          error_arcsec / layers_per_table,
          0,
          [device, precision, error_arcsec](const IndexTable &table,
                                            std::span<const f64::RayStart> starts) -> std::unique_ptr<Runner> {
            if (precision == Precision::double_)
              return std::make_unique<LayerRunner<double>>(device, table, error_arcsec, starts);
            return std::make_unique<LayerRunner<float>>(device, table, error_arcsec, starts);
          }};
}

Method stepping_method(const std::shared_ptr<Device> &device) {
  TraceOptions options;
  options.storage = TableStorage::buffer;
  return stepping(device, options, middle);
}

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
  add_layers(methods, one_lane, Precision::single_, {0.01});
  add(methods, one_lane, o, {middle});
  add(methods, one_lane, paper, {middle});
  if (device->info().has_double) add(methods, one_lane, fine, {middle});
  return methods;
}

}  // namespace greenray::bench
