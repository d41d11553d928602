#pragma once
/// What the particles of tiles add to nodes, and its sums.
///
/// The particles of a tile add to its window, in memory of their thread, where it stays in the cache. Then the window is added at
/// the nodes of the tiles around. At each of them windows take turns in the order of their tiles, so sums are the same bits
/// for any number of threads and owners. Threads do not wait: the parts of a window whose turn has not come, because another
/// thread is at work on those before, are kept and added at the end. So are windows that other owners need or have sent.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <new>
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
    for (Worker& worker : workers_)  // there may once have been far more than are needed
      worker.rooms.resize(std::min<std::size_t>(worker.rooms.size(), 1));
    begin();
  }

  /// Begins new sums; those that have not ended are lost.
  void begin() {
    next_.assign(turns_.size(), 0);
    kept_.assign(turns_.size(), nullptr);
    for (Worker& worker : workers_) worker.n_full = worker.used = 0;
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
  /// Adds at the `nodes` what the particles of tile t have added, and makes it zeros again. If asked to, keeps all of it, too.
  template <class Node>
  TALUS_FLATTEN void add(int t, int worker, Node* nodes, bool keeps) {
    using Number = decltype(load_node(*nodes));
    Node* const window = open<Node>(worker);
    KeptParts* kept = nullptr;
    int n_kept_nodes = 0;
    const auto add_part = [&]<int n>(std::integral_constant<int, n>) {  // at the tile that sees this one as neighbour n
      constexpr Index<Dim> offset = offset_of<Dim>(n);
      const int other = tiles_[t].neighbours[opposite(n)];
      const int turn = turns_[std::size_t(t)].at[std::size_t(opposite(n))];
      const bool is_turn = other >= 0 && next_at(other).load(std::memory_order_acquire) == turn;
      if (keeps || (other >= 0 && !is_turn)) {
        if (!kept) kept = place_to_keep<Node>(worker);
        kept->first[n] = static_cast<unsigned short>(n_kept_nodes);
        Node* to = kept->template part<Node>(n);
        detail::for_each_shared<Dim, Shape>(offset, [&](int, int w) { copy_node(window[w], *to++); });
        n_kept_nodes += size_of_part(n);
      }
      if (!is_turn) {
        detail::for_each_shared<Dim, Shape>(offset, [&](int, int w) { store_node(window[w], Number(0.0)); });
        return;
      }
      Node* const sums = nodes + std::size_t(other) * Layout::n_nodes;
      if (turn == 0) std::fill_n(sums, Layout::n_nodes, Node{});
      detail::for_each_shared<Dim, Shape>(offset, [&](int own, int w) {
        store_node(sums[own], load_node(sums[own]) + load_node(window[w]));
        store_node(window[w], Number(0.0));
      });
      next_at(other).store(static_cast<unsigned char>(turn + 1), std::memory_order_release);
    };
    [&]<int... n>(std::integer_sequence<int, n...>) { (add_part(std::integral_constant<int, n>()), ...); }
    (std::make_integer_sequence<int, n_neighbours<Dim>>());
    if (kept) keep<Node>(t, worker, kept, n_kept_nodes);
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
      add_kept(neighbour, *kept_[std::size_t(tiles_[t].neighbours[neighbour])], sums);
    }
  }

  /// The windows that are kept whole, and those of other owners, for their exchange: part after part.
  template <class Node>
  struct Kept {
    using Value = Node;
    static constexpr int n = Layout::n_window;
    Windows& windows;

    Node* of(int t) const {
      KeptParts* const kept = windows.kept_[std::size_t(t)];
      return (kept ? kept : windows.keep_all<Node>(t, 0))->template part<Node>(0);
    }
  };
  template <class Node>
  Kept<Node> kept() {
    return {*this};
  }

  /// Memory [bytes].
  std::size_t bytes() const {
    std::size_t n = turns_.capacity() * (sizeof(Turns) + 1 + sizeof(void*));
    for (const Worker& worker : workers_) {
      n += worker.open.bytes();
      for (const auto& room : worker.rooms) n += room->bytes();
    }
    return n;
  }

 private:
  /// Of a tile, when its window is added at the nodes of each neighbour, and how many are added at its own nodes.
  struct Turns {
    std::array<unsigned char, n_neighbours<Dim>> at;
    unsigned char n_windows;
  };
  /// Parts of a window that are kept, each for the nodes of a tile around it: part n for the tile that sees the window's as
  /// neighbour n. Their nodes are behind it.
  struct alignas(64) KeptParts {
    std::array<unsigned short, n_neighbours<Dim>> first;  ///< node of each part that is kept

    template <class Node>
    Node* part(int n) {
      return reinterpret_cast<Node*>(this + 1) + first[std::size_t(n)];
    }
  };
  /// Memory of a thread, on cache lines of its own.
  struct alignas(64) Worker {
    Room open;
    std::vector<std::unique_ptr<Room>> rooms;  ///< of what is kept
    std::size_t n_full = 0;                    ///< of these
    std::size_t used = 0;                      ///< of the room after them [bytes]
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
  /// Adds the part of a tile's neighbour at the nodes of the tile.
  template <class Node>
  TALUS_FLATTEN static void add_kept(int neighbour, KeptParts& kept, Node* sums) {
    const Node* from = kept.template part<Node>(neighbour);
    const auto add = [&]<int n>(std::integral_constant<int, n>) {
      if (n == neighbour)
        detail::for_each_shared<Dim, Shape>(
            offset_of<Dim>(n), [&](int own, int) { store_node(sums[own], load_node(sums[own]) + load_node(*from++)); });
    };
    [&]<int... n>(std::integer_sequence<int, n...>) { (add(std::integral_constant<int, n>()), ...); }
    (std::make_integer_sequence<int, n_neighbours<Dim>>());
  }
  /// Number of nodes in a part.
  static constexpr int size_of_part(int n) {
    int size = 1;
    for (const int along : offset_of<Dim>(n)) size *= detail::overlap<Layout>(along).count;
    return size;
  }
  /// Memory of a thread for the parts of one more window.
  template <class Node>
  TALUS_NOINLINE KeptParts* place_to_keep(int worker) {
    static_assert(std::is_trivially_copyable_v<Node> && alignof(Node) <= alignof(KeptParts));
    constexpr std::size_t room = std::size_t(1) << 17, most = sizeof(KeptParts) + bytes_of<Node>;
    Worker& of = workers_[std::size_t(worker)];
    if (of.n_full < of.rooms.size() && of.used + most > of.rooms[of.n_full]->bytes() && of.used > 0) {
      ++of.n_full;
      of.used = 0;
    }
    if (of.n_full == of.rooms.size()) of.rooms.push_back(std::make_unique<Room>());
    of.rooms[of.n_full]->enlarge(std::max(room, most));
    return new (of.rooms[of.n_full]->template at<std::byte>(of.used)) KeptParts;
  }
  /// Keeps parts of tile t that are there, in use until the next sums begin.
  template <class Node>
  void keep(int t, int worker, KeptParts* parts, int n_nodes) {
    constexpr std::size_t line = 64;
    const std::size_t bytes = sizeof(KeptParts) + std::size_t(n_nodes) * sizeof(Node);
    workers_[std::size_t(worker)].used += (bytes + line - 1) / line * line;
    kept_[std::size_t(t)] = parts;
  }
  /// Keeps all parts of tile t, unset.
  template <class Node>
  KeptParts* keep_all(int t, int worker) {
    KeptParts* const kept = place_to_keep<Node>(worker);
    int n_nodes = 0;
    for (int n = 0; n < n_neighbours<Dim>; ++n) {
      kept->first[std::size_t(n)] = static_cast<unsigned short>(n_nodes);
      n_nodes += size_of_part(n);
    }
    keep<Node>(t, worker, kept, n_nodes);
    return kept;
  }

  const Tile<Dim>* tiles_ = nullptr;
  std::vector<Turns> turns_;
  std::vector<unsigned char> next_;
  std::vector<KeptParts*> kept_;
  std::vector<Worker> workers_;
};

}  // namespace talus
