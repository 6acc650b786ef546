// Curved rays on a device through air that varies along the surface.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "atmosphere/section_table.hpp"
#include "compute/ray_tracer.hpp"
#include "twin/section_twin.hpp"

namespace greenray {

class SectionTracer {
 public:
  /// Uploads the table. options.storage is not used: cells lie in a buffer. Throws DeviceError if double is asked of a
  /// device without it.
  SectionTracer(std::shared_ptr<Device> device, const SectionTable &table, const TraceOptions &options);
  ~SectionTracer();

  /// Traces in batches that fit the budget. Results do not depend on batch or local size.
  std::vector<f64_section::RayEnd> trace(std::span<const f64_section::RayStart> starts);

  const TraceStats &stats() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The table's parts as a device, or the host twin, holds them.
template <class Cell>
std::vector<Cell> section_cells(const SectionTable &table) {
  using Scalar = decltype(Cell::bottom_m);
  std::vector<Cell> cells;
  cells.reserve(table.cells.size());
  for (const SectionCellData &from : table.cells) {
    Cell cell{};
    for (int k = 0; k < 16; ++k) cell.slope[k] = static_cast<Scalar>(from.slope[k]);
    for (int k = 0; k < 4; ++k) {
      cell.base[k] = static_cast<Scalar>(from.base[k]);
      cell.density[k] = static_cast<Scalar>(from.density[k]);
    }
    cell.bottom_m = static_cast<Scalar>(from.bottom_m);
    cell.thickness_m = static_cast<Scalar>(from.thickness_m);
    cell.step_cap_m = static_cast<Scalar>(from.step_cap_m);
    cells.push_back(cell);
  }
  return cells;
}
template <class Column>
std::vector<Column> section_columns(const SectionTable &table) {
  using Scalar = decltype(Column::width_m);
  std::vector<Column> columns;
  for (const SectionColumnData &c : table.columns)
    columns.push_back({static_cast<Scalar>(c.width_m), static_cast<Scalar>(c.width_m > 0 ? 1 / c.width_m : 0),
                       static_cast<int>(c.first_cell), static_cast<int>(c.cells)});
  return columns;
}
template <class Row>
std::vector<Row> section_rows(const SectionTable &table) {
  using Scalar = decltype(Row::factor);
  std::vector<Row> rows;
  for (const SectionRowData &r : table.rows)
    rows.push_back({static_cast<Scalar>(r.factor), static_cast<int>(r.first_column), static_cast<int>(r.columns)});
  return rows;
}

}  // namespace greenray
