#include "talus/backend/mpi/tile_division.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "talus/backend/transport.hpp"

namespace talus {

namespace {

void expect_success(int status) {
  if (status != ZOLTAN_OK && status != ZOLTAN_WARN)
    throw std::runtime_error("Zoltan cannot divide the tiles among the processes");
}

/// What Zoltan asks a process: the tiles of its stretch, [begin, end).
struct Stretch {
  TilesOfRun tiles;
  std::size_t begin, end;

  Stretch(const TilesOfRun& all, MPI_Comm processes) : tiles(all) {
    int n, own;
    MPI_Comm_size(processes, &n);
    MPI_Comm_rank(processes, &own);
    begin = all.work->size() * std::size_t(own) / std::size_t(n);
    end = all.work->size() * (std::size_t(own) + 1) / std::size_t(n);
  }
  /// Coordinates of a tile, in tiles. They are slightly sheared, so that no two tiles have the same: a cut between those of a
  /// plane leaves parts of equal work, where a cut beside the plane would not.
  void place(std::size_t tile, double* x) const {
    const int* along = tiles.places->data() + tile * std::size_t(tiles.dim);
    for (int a = 0; a < tiles.dim; ++a) {
      double share = 1;
      x[a] = 0;
      for (int k = 0; k < tiles.dim; ++k, share *= 1e-3) x[a] += share * along[(a + k) % tiles.dim];
    }
  }

  static const Stretch& of(void* data) { return *static_cast<const Stretch*>(data); }
  static int count(void* data, int* error) {
    *error = ZOLTAN_OK;
    return int(of(data).end - of(data).begin);
  }
  static void list(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR, int, float* weights, int* error) {
    const Stretch& s = of(data);
    for (std::size_t t = s.begin; t < s.end; ++t) {
      global[t - s.begin] = ZOLTAN_ID_TYPE(t);
      weights[t - s.begin] = float((*s.tiles.work)[t]);
    }
    *error = ZOLTAN_OK;
  }
  static int dimension(void* data, int* error) {
    *error = ZOLTAN_OK;
    return of(data).tiles.dim;
  }
  static void places(void* data, int, int, int n, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR, int dim, double* x, int* error) {
    for (int i = 0; i < n; ++i) of(data).place(global[i], x + std::ptrdiff_t(i) * dim);
    *error = ZOLTAN_OK;
  }
};

}  // namespace

TileDivision::TileDivision(MPI_Comm processes) : processes_(processes) {
  float version;
  expect_success(Zoltan_Initialize(0, nullptr, &version));
}

void TileDivision::cut(const TilesOfRun& tiles) {
  Stretch stretch(tiles, processes_);
  zoltan_.reset(Zoltan_Create(processes_));
  dim_ = tiles.dim;
  Zoltan_Struct* z = zoltan_.get();
  const std::pair<const char*, const char*> settings[] = {
      {"DEBUG_LEVEL", "0"},    {"LB_METHOD", "RCB"},     {"NUM_GID_ENTRIES", "1"}, {"NUM_LID_ENTRIES", "0"},
      {"OBJ_WEIGHT_DIM", "1"}, {"RETURN_LISTS", "NONE"}, {"KEEP_CUTS", "1"},       {"IMBALANCE_TOL", "1.01"},
  };
  for (const auto& [name, value] : settings) expect_success(Zoltan_Set_Param(z, name, value));
  Zoltan_Set_Num_Obj_Fn(z, Stretch::count, &stretch);
  Zoltan_Set_Obj_List_Fn(z, Stretch::list, &stretch);
  Zoltan_Set_Num_Geom_Fn(z, Stretch::dimension, &stretch);
  Zoltan_Set_Geom_Multi_Fn(z, Stretch::places, &stretch);
  int changes, n_global, n_local, n_in, n_out;
  ZOLTAN_ID_PTR in = nullptr, in_here = nullptr, out = nullptr, out_here = nullptr;
  int *in_from = nullptr, *in_part = nullptr, *out_to = nullptr, *out_part = nullptr;
  const int status = Zoltan_LB_Partition(z, &changes, &n_global, &n_local, &n_in, &in, &in_here, &in_from, &in_part,
                                         &n_out, &out, &out_here, &out_to, &out_part);
  Zoltan_LB_Free_Part(&in, &in_here, &in_from, &in_part);
  Zoltan_LB_Free_Part(&out, &out_here, &out_to, &out_part);
  expect_success(status);
}

std::vector<double> TileDivision::parts(const TilesOfRun& tiles) const {
  const Stretch stretch(tiles, processes_);
  std::vector<double> parts;
  for (std::size_t t = stretch.begin; t < stretch.end; ++t) {
    double x[3] = {};
    stretch.place(t, x);
    int process, part;
    expect_success(Zoltan_LB_Point_PP_Assign(zoltan_.get(), x, &process, &part));
    parts.push_back(part);
  }
  return parts;
}

double imbalance(const std::vector<int>& owners, const std::vector<long>& work, int n_owners) {
  std::vector<double> of_owner(std::size_t(n_owners), 0.0);
  double all = 0;
  for (std::size_t t = 0; t < work.size(); ++t) {
    of_owner[std::size_t(owners[t])] += double(work[t]);
    all += double(work[t]);
  }
  return all > 0 ? *std::max_element(of_owner.begin(), of_owner.end()) * n_owners / all : 1;
}

void LossOfDivision::start(const std::vector<int>& owners, const std::vector<long>& work, int n_owners) {
  at_start_ = imbalance(owners, work, n_owners);
  lost_ = 0;
}

bool LossOfDivision::calls_for_a_cut(const std::vector<int>& owners, const std::vector<long>& work, int n_owners,
                                     long n_steps) {
  // A cut takes Zoltan's time for each tile [ns], measured (docs/many_machines.md), and as long as steps in which half of the
  // particles are given away.
  constexpr double of_tile = 4e3, steps_to_give_away = 1;
  const double now = imbalance(owners, work, n_owners);
  const double mean = std::accumulate(work.begin(), work.end(), 0.0) / n_owners;
  lost_ += double(n_steps) * mean * std::max(0.0, now - at_start_);
  return now > most_imbalance || lost_ > of_tile * double(work.size()) + steps_to_give_away * mean;
}

}  // namespace talus
