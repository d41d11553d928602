#pragma once
/// What the particles of tiles add to nodes, and its sums.
///
/// The particles of a tile add to its window, in memory of their thread, where it stays in the cache. Then the window is added at
/// the nodes of the tiles around. At each of them windows take turns in the order of their tiles, so sums are the same bits
/// for any number of threads and owners. Threads do not wait: a window whose turn has not come, because another thread is at
/// work on those before, is kept and added at the end. So are those that other owners need or have sent.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "talus/mpm/backend.hpp"
#include "talus/mpm/data/grid.hpp"

namespace talus {

/// Windows of a kind of node at a time, and their turns.
template <int Dim, class Shape>
class Windows {
 public:
  using Layout = TileLayout<Dim, Shape>;

  explicit Windows(int n_workers) : workers_(std::size_t(n_workers)) {}

  /// Sets new tiles.
  void rest_on(const Tile<Dim>* tiles, int n_tiles, Backend& backend) {
    tiles_ = tiles;
    turns_.resize(std::size_t(n_tiles));
    for_each_of(backend, turns_.size(), [&](std::size_t t) { find_turns(int(t)); });
    for (Worker& worker : workers_) worker.kept.clear();  // as many as there once were may be far more than are needed
    begin();
  }

  /// Begins new sums; those that have not ended are lost.
  void begin() {
    next_.assign(turns_.size(), 0);
    kept_.assign(turns_.size(), nullptr);
    for (Worker& worker : workers_) worker.n_kept = 0;
  }
  /// Where the particles of a tile add, for the worker that has it: zeros.
  template <class Node>
  Node* open(int worker) {
    Room& room = workers_[std::size_t(worker)].open;
    if (room.bytes() < bytes_of<Node>) {
      room.enlarge(bytes_of<Node>);
      std::fill_n(room.template at<std::byte>(0), room.bytes(), std::byte{});
    }
    return room.template at<Node>(0);
  }
  /// Makes it zeros again.
  template <class Node>
  void clear(int worker) {
    clear_window<Dim, Shape>(open<Node>(worker));
  }
  /// Adds at the `nodes` what the particles of tile t have added, and makes it zeros again. If asked to, keeps the window.
  template <class Node>
  void add(int t, int worker, Node* nodes, bool keeps) {
    Node* const window = open<Node>(worker);
    if (!keeps && is_turn_everywhere(t)) return add_everywhere(t, window, nodes);
    const bool is_added = add_in_turn(t, window, nodes);
    if (keeps || !is_added) std::copy_n(window, Layout::n_window, keep<Node>(t, worker));
    clear<Node>(worker);
  }
  /// Once all windows have been added, or kept: adds those left at the nodes of tile t, which no other tile shares.
  template <class Node>
  void finish(int t, Node* nodes) {
    unsigned char& next = next_[std::size_t(t)];
    const Turns& turns = turns_[std::size_t(t)];
    Node* const sums = nodes + std::size_t(t) * Layout::n_nodes;
    if (next == 0) std::fill_n(sums, Layout::n_nodes, Node{});
    if (next == turns.n_windows) return;
    std::array<int, n_neighbours<Dim>> order;  // neighbours as their turns come
    for (int n = 0; n < n_neighbours<Dim>; ++n)
      if (const int other = tiles_[t].neighbours[n]; other >= 0 && tiles_[other].occupied)
        order[std::size_t(turns_[std::size_t(other)].at[opposite(n)])] = n;
    for (; next < turns.n_windows; ++next) {
      const int neighbour = order[next];
      add_part_of(neighbour, kept_[std::size_t(tiles_[t].neighbours[neighbour])]->template at<Node>(0), sums);
    }
  }

  /// The windows that are kept, for their exchange between owners.
  template <class Node>
  struct Kept {
    using Value = Node;
    static constexpr int n = Layout::n_window;
    Windows& windows;

    Node* of(int t) const { return windows.keep<Node>(t, 0); }
  };
  template <class Node>
  Kept<Node> kept() {
    return {*this};
  }

  /// Memory [bytes].
  std::size_t bytes() const {
    std::size_t n = turns_.capacity() * (sizeof(Turns) + sizeof(Room*) + 1);
    for (const Worker& worker : workers_) {
      n += worker.open.bytes();
      for (const auto& room : worker.kept) n += room->bytes();
    }
    return n;
  }

 private:
  /// Of a tile, when its window is added at the nodes of each neighbour, and how many are added at its own nodes.
  struct Turns {
    std::array<unsigned char, n_neighbours<Dim>> at;
    unsigned char n_windows;
  };
  /// Memory of a thread, on cache lines of its own.
  struct alignas(64) Worker {
    Room open;
    std::vector<std::unique_ptr<Room>> kept;
    std::size_t n_kept = 0;  ///< of these, in use
  };

  template <class Node>
  static constexpr std::size_t bytes_of = Layout::n_window * sizeof(Node);
  /// The number by which a neighbour sees a tile.
  static constexpr int opposite(int neighbour) { return n_neighbours<Dim> - 1 - neighbour; }
  /// In a period of one or two tiles, a tile may be several neighbours of another one: they come in the order of their numbers.
  void find_turns(int t) {
    std::array<std::pair<int, int>, n_neighbours<Dim>> around;  // tile, and the number of the neighbour
    int n_windows = 0;
    for (int n = 0; n < n_neighbours<Dim>; ++n)
      if (const int other = tiles_[t].neighbours[n]; other >= 0 && tiles_[other].occupied)
        around[std::size_t(n_windows++)] = {other, n};
    std::sort(around.begin(), around.begin() + n_windows);
    for (int turn = 0; turn < n_windows; ++turn) {
      const auto& [other, n] = around[std::size_t(turn)];
      turns_[std::size_t(other)].at[std::size_t(opposite(n))] = static_cast<unsigned char>(turn);
    }
    turns_[std::size_t(t)].n_windows = static_cast<unsigned char>(n_windows);
  }
  /// The turn that is next at a tile.
  auto next_at(int t) { return std::atomic_ref(next_[std::size_t(t)]); }
  bool is_turn_everywhere(int t) {
    const Turns& turns = turns_[std::size_t(t)];
    for (int n = 0; n < n_neighbours<Dim>; ++n) {
      const int other = tiles_[t].neighbours[n];
      if (other >= 0 && next_at(other).load(std::memory_order_acquire) != turns.at[std::size_t(n)]) return false;
    }
    return true;
  }
  /// The nodes of a tile, zeros if the window whose turn it is is the first one there.
  template <class Node>
  static Node* sums_at(int t, int turn, Node* nodes) {
    Node* const sums = nodes + std::size_t(t) * Layout::n_nodes;
    if (turn == 0) std::fill_n(sums, Layout::n_nodes, Node{});
    return sums;
  }
  /// Adds the window of tile t at the nodes of all tiles around, and makes it zeros.
  template <class Node>
  TALUS_FLATTEN void add_everywhere(int t, Node* window, Node* nodes) {
    using Number = decltype(load_node(*window));
    const auto add = [&]<int n>(std::integral_constant<int, n>) {  // the tile that sees this one as neighbour n
      constexpr Index<Dim> offset = offset_of<Dim>(n);
      const int other = tiles_[t].neighbours[opposite(n)];
      if (other < 0) {
        detail::for_each_shared<Dim, Shape>(offset, [&](int, int w) { store_node(window[w], Number(0.0)); });
        return;
      }
      const int turn = turns_[std::size_t(t)].at[opposite(n)];
      Node* const sums = sums_at(other, turn, nodes);
      detail::for_each_shared<Dim, Shape>(offset, [&](int own, int w) {
        store_node(sums[own], load_node(sums[own]) + load_node(window[w]));
        store_node(window[w], Number(0.0));
      });
      next_at(other).store(static_cast<unsigned char>(turn + 1), std::memory_order_release);
    };
    [&]<int... n>(std::integer_sequence<int, n...>) { (add(std::integral_constant<int, n>()), ...); }
    (std::make_integer_sequence<int, n_neighbours<Dim>>());
  }
  /// Adds it where its turn has come. Returns whether it has everywhere.
  template <class Node>
  TALUS_FLATTEN bool add_in_turn(int t, const Node* window, Node* nodes) {
    bool is_added = true;
    for (int n = 0; n < n_neighbours<Dim>; ++n) {
      const int other = tiles_[t].neighbours[opposite(n)];
      if (other < 0) continue;
      const int turn = turns_[std::size_t(t)].at[std::size_t(opposite(n))];
      if (next_at(other).load(std::memory_order_acquire) != turn) {
        is_added = false;
        continue;
      }
      add_part_of(n, window, sums_at(other, turn, nodes));
      next_at(other).store(static_cast<unsigned char>(turn + 1), std::memory_order_release);
    }
    return is_added;
  }
  /// `add_part` for any neighbour.
  template <class Node>
  TALUS_FLATTEN static void add_part_of(int neighbour, const Node* window, Node* sums) {
    for_constants<n_neighbours<Dim>>([&](auto n) {
      if (int(n) == neighbour) add_part<n, Dim, Shape>(window, sums);
    });
  }
  /// Memory for the window of tile t, in use until the next sums begin.
  template <class Node>
  Node* keep(int t, int worker) {
    Room*& kept = kept_[std::size_t(t)];
    if (!kept) {
      Worker& of = workers_[std::size_t(worker)];
      if (of.n_kept == of.kept.size()) of.kept.push_back(std::make_unique<Room>());
      kept = of.kept[of.n_kept++].get();
      kept->enlarge(bytes_of<Node>);
    }
    return kept->template at<Node>(0);
  }

  const Tile<Dim>* tiles_ = nullptr;
  std::vector<Turns> turns_;
  std::vector<unsigned char> next_;
  std::vector<Room*> kept_;
  std::vector<Worker> workers_;
};

}  // namespace talus
