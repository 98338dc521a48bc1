// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/ordering/minimum_degree.h"

#include <algorithm>
#include <cstdint>

namespace formwright {
namespace {

// The quotient graph. A vertex is a variable (not yet eliminated; stands for `members` vertices that
// have the same neighbours), an element (an eliminated pivot: its list is the clique it left behind),
// or gone (absorbed by another).
class QuotientGraph {
 public:
  QuotientGraph(const Graph& graph, int inner);
  std::vector<int> eliminate_all();

 private:
  enum class Kind : std::uint8_t { variable, element, gone };

  bool is_halo(int i) const { return i >= inner_; }
  void insert_by_degree(int i);
  void remove_from_degrees(int i);
  int take_minimum();
  void make_room(std::size_t needed);
  void form_element(int pivot);
  void subtract_overlaps(int pivot);
  void update_degrees(int pivot);
  void merge_indistinguishable(int pivot);
  void finish_element(int pivot);
  bool same_lists(int i, int j) const;
  void append_members(int to, int from);
  void emit(int variable);

  int n_, inner_;
  int left_;                // inner vertices not yet eliminated
  int halo_left_ = 0;       // halo vertices
  std::vector<int> lists_;  // every variable: its elements, then its variables; every element: its variables
  std::size_t used_ = 0;    // of lists_
  std::vector<std::size_t> begin_;
  std::vector<int> length_, elements_;  // of the list; of it, how many are elements
  std::vector<int> size_;               // vertices in a variable; negative while it belongs to the pivot's element
  std::vector<int> degree_;
  std::vector<Kind> kind_;
  std::vector<int> bucket_, next_, previous_;  // doubly linked lists by degree
  int minimum_ = 0;
  std::vector<std::int64_t> overlap_;  // of elements: stamp + |Le \ Lp|
  std::int64_t stamp_ = 1;
  std::vector<int> hash_bucket_, hash_next_;
  std::vector<unsigned> hash_;
  std::vector<int> seen_;
  int seen_stamp_ = 0;
  std::vector<int> next_member_, last_member_;
  std::vector<int> order_;
};

QuotientGraph::QuotientGraph(const Graph& graph, int inner)
    : n_(graph.size()), inner_(inner), left_(inner), halo_left_(n_ - inner) {
  lists_.resize(graph.neighbour.size() + graph.neighbour.size() / 4 + static_cast<std::size_t>(n_) + 1);
  std::copy(graph.neighbour.begin(), graph.neighbour.end(), lists_.begin());
  used_ = graph.neighbour.size();
  begin_.assign(graph.start.begin(), graph.start.end() - 1);
  length_.resize(n_);
  degree_.resize(n_);
  elements_.assign(n_, 0);
  size_.assign(n_, 1);
  kind_.assign(n_, Kind::variable);
  bucket_.assign(n_, -1);
  next_.assign(n_, -1);
  previous_.assign(n_, -1);
  overlap_.assign(n_, 0);
  hash_bucket_.assign(n_, -1);
  hash_next_.assign(n_, -1);
  hash_.assign(n_, 0);
  seen_.assign(n_, 0);
  next_member_.assign(n_, -1);
  last_member_.resize(n_);
  order_.reserve(inner_);
  minimum_ = n_;
  for (int i = 0; i < n_; ++i) {
    length_[i] = static_cast<int>(graph.start[i + 1] - graph.start[i]);
    degree_[i] = length_[i];
    last_member_[i] = i;
    if (!is_halo(i)) insert_by_degree(i);
  }
}

void QuotientGraph::insert_by_degree(int i) {
  const int d = degree_[i];
  next_[i] = bucket_[d];
  previous_[i] = -1;
  if (bucket_[d] != -1) previous_[bucket_[d]] = i;
  bucket_[d] = i;
  minimum_ = std::min(minimum_, d);
}

void QuotientGraph::remove_from_degrees(int i) {
  if (is_halo(i)) return;
  if (next_[i] != -1) previous_[next_[i]] = previous_[i];
  if (previous_[i] != -1) {
    next_[previous_[i]] = next_[i];
  } else {
    bucket_[degree_[i]] = next_[i];
  }
}

int QuotientGraph::take_minimum() {
  while (bucket_[minimum_] == -1) ++minimum_;
  const int pivot = bucket_[minimum_];
  remove_from_degrees(pivot);
  return pivot;
}

// Moves all live lists to the front when the next element would not fit behind them.
void QuotientGraph::make_room(std::size_t needed) {
  if (used_ + needed <= lists_.size()) return;
  std::vector<int> live;
  live.reserve(n_);
  for (int i = 0; i < n_; ++i) {
    if (kind_[i] != Kind::gone) live.push_back(i);
  }
  std::sort(live.begin(), live.end(), [&](int a, int b) { return begin_[a] < begin_[b]; });
  used_ = 0;
  for (const int i : live) {
    std::copy_n(lists_.begin() + static_cast<std::ptrdiff_t>(begin_[i]), length_[i],
                lists_.begin() + static_cast<std::ptrdiff_t>(used_));
    begin_[i] = used_;
    used_ += static_cast<std::size_t>(length_[i]);
  }
  if (used_ + needed > lists_.size()) lists_.resize(used_ + needed);
}

// Lp: all variables next to the pivot, directly or through its elements, which it absorbs.
void QuotientGraph::form_element(int pivot) {
  const bool in_place = elements_[pivot] == 0;
  if (!in_place) make_room(static_cast<std::size_t>(std::min(degree_[pivot] + 1, n_)));
  std::size_t read = begin_[pivot];
  std::size_t write = in_place ? read : used_;
  const std::size_t first = write;
  int total = 0;
  const auto take = [&](std::size_t from, int count) {
    for (int k = 0; k < count; ++k) {
      const int i = lists_[from + static_cast<std::size_t>(k)];
      if (size_[i] <= 0) continue;  // gone, or already in Lp
      total += size_[i];
      size_[i] = -size_[i];
      lists_[write++] = i;
      remove_from_degrees(i);
    }
  };
  left_ -= size_[pivot];
  size_[pivot] = -size_[pivot];
  const int own_elements = elements_[pivot];
  for (int k = 0; k < own_elements; ++k) {
    const int e = lists_[read++];
    take(begin_[e], length_[e]);
    kind_[e] = Kind::gone;
    overlap_[e] = 0;
  }
  take(read, length_[pivot] - own_elements);
  if (!in_place) used_ = write;
  begin_[pivot] = first;
  length_[pivot] = static_cast<int>(write - first);
  elements_[pivot] = 0;
  degree_[pivot] = total;
  kind_[pivot] = Kind::element;
}

// overlap_[e] - stamp_ becomes |Le \ Lp| for every element e that touches Lp.
void QuotientGraph::subtract_overlaps(int pivot) {
  for (int k = 0; k < length_[pivot]; ++k) {
    const int i = lists_[begin_[pivot] + static_cast<std::size_t>(k)];
    const int size = -size_[i];
    for (int q = 0; q < elements_[i]; ++q) {
      const int e = lists_[begin_[i] + static_cast<std::size_t>(q)];
      if (overlap_[e] >= stamp_) {
        overlap_[e] -= size;
      } else if (kind_[e] == Kind::element) {
        overlap_[e] = degree_[e] + stamp_ - size;
      }
    }
  }
}

void QuotientGraph::update_degrees(int pivot) {
  for (int k = 0; k < length_[pivot]; ++k) {
    const int i = lists_[begin_[pivot] + static_cast<std::size_t>(k)];
    const std::size_t first = begin_[i];
    std::size_t write = first;
    unsigned hash = 0;
    std::int64_t degree = 0;
    for (int q = 0; q < elements_[i]; ++q) {
      const int e = lists_[first + static_cast<std::size_t>(q)];
      if (kind_[e] != Kind::element) continue;
      const std::int64_t outside = overlap_[e] - stamp_;
      if (outside > 0) {
        degree += outside;
        lists_[write++] = e;
        hash += static_cast<unsigned>(e);
      } else {
        kind_[e] = Kind::gone;  // aggressive absorption: Le is inside Lp
        overlap_[e] = 0;
      }
    }
    const std::size_t after_elements = write;
    for (std::size_t q = first + static_cast<std::size_t>(elements_[i]);
         q < first + static_cast<std::size_t>(length_[i]); ++q) {
      const int j = lists_[q];
      if (size_[j] <= 0) continue;
      degree += size_[j];
      lists_[write++] = j;
      hash += static_cast<unsigned>(j);
    }
    if (degree == 0 && !is_halo(i)) {  // no neighbour outside Lp: eliminate it with the pivot
      const int size = -size_[i];
      left_ -= size;
      degree_[pivot] -= size;
      size_[i] = 0;
      kind_[i] = Kind::gone;
      append_members(pivot, i);
      continue;
    }
    degree_[i] = static_cast<int>(std::min<std::int64_t>(degree_[i], degree));
    // The pivot becomes the first element; what it displaces moves behind. There is room: the list
    // lost the pivot itself or an element that the pivot absorbed.
    lists_[write] = lists_[after_elements];
    lists_[after_elements] = lists_[first];
    lists_[first] = pivot;
    elements_[i] = static_cast<int>(after_elements - first) + 1;
    length_[i] = static_cast<int>(write - first) + 1;
    hash %= static_cast<unsigned>(n_);
    hash_[i] = hash;
    hash_next_[i] = hash_bucket_[hash];
    hash_bucket_[hash] = i;
  }
}

bool QuotientGraph::same_lists(int i, int j) const {
  if (length_[i] != length_[j] || elements_[i] != elements_[j]) return false;
  for (int k = 1; k < length_[j]; ++k) {
    if (seen_[lists_[begin_[j] + static_cast<std::size_t>(k)]] != seen_stamp_) return false;
  }
  return true;
}

void QuotientGraph::merge_indistinguishable(int pivot) {
  for (int k = 0; k < length_[pivot]; ++k) {
    const int first = lists_[begin_[pivot] + static_cast<std::size_t>(k)];
    if (size_[first] >= 0) continue;
    int i = hash_bucket_[hash_[first]];
    hash_bucket_[hash_[first]] = -1;
    for (; i != -1 && hash_next_[i] != -1; i = hash_next_[i]) {
      ++seen_stamp_;
      for (int q = 1; q < length_[i]; ++q) seen_[lists_[begin_[i] + static_cast<std::size_t>(q)]] = seen_stamp_;
      for (int last = i, j = hash_next_[i]; j != -1; j = hash_next_[j]) {
        if (is_halo(i) == is_halo(j) && same_lists(i, j)) {
          size_[i] += size_[j];
          size_[j] = 0;
          kind_[j] = Kind::gone;
          append_members(i, j);
          hash_next_[last] = hash_next_[j];
        } else {
          last = j;
        }
      }
    }
  }
}

// Lp keeps what is still a variable; its members return to the degree lists.
void QuotientGraph::finish_element(int pivot) {
  std::size_t write = begin_[pivot];
  const std::size_t end = begin_[pivot] + static_cast<std::size_t>(length_[pivot]);
  for (std::size_t q = begin_[pivot]; q < end; ++q) {
    const int i = lists_[q];
    if (size_[i] >= 0) continue;
    size_[i] = -size_[i];
    const int bound = left_ + halo_left_ - size_[i];
    degree_[i] = std::min(degree_[i] + degree_[pivot] - size_[i], bound);
    if (!is_halo(i)) insert_by_degree(i);
    lists_[write++] = i;
  }
  size_[pivot] = 0;
  length_[pivot] = static_cast<int>(write - begin_[pivot]);
  if (length_[pivot] == 0) kind_[pivot] = Kind::gone;
  if (end == used_) used_ = write;
}

void QuotientGraph::append_members(int to, int from) {
  next_member_[last_member_[to]] = from;
  last_member_[to] = last_member_[from];
}

void QuotientGraph::emit(int variable) {
  for (int i = variable; i != -1; i = next_member_[i]) order_.push_back(i);
}

std::vector<int> QuotientGraph::eliminate_all() {
  while (left_ > 0) {
    const int pivot = take_minimum();
    form_element(pivot);
    subtract_overlaps(pivot);
    update_degrees(pivot);
    stamp_ += n_ + 1;  // every overlap computed so far becomes stale
    merge_indistinguishable(pivot);
    finish_element(pivot);
    emit(pivot);
  }
  return std::move(order_);
}

}  // namespace

std::vector<int> minimum_degree(const Graph& graph, int inner) {
  if (inner == 0) return {};
  return QuotientGraph(graph, inner).eliminate_all();
}

}  // namespace formwright
