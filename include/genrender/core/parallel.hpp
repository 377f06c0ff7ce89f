// SPDX-License-Identifier: MIT
// The parallel loop: the one customisation point through which the library uses more than one thread.
#pragma once

#include <genrender/core/begin_header.inl>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// What a loop calls with each of its indices, whatever its type: a reference to a function that outlives the loop.
class loop_body {
public:
    /// Refers to any function of an index, which has to outlive this.
    template <class Body>
        requires(!std::is_same_v<std::remove_cvref_t<Body>, loop_body> && std::is_invocable_v<Body&, std::size_t>)
    loop_body(Body&& body)
        : body_(std::addressof(body)), call_([](void const* function, std::size_t i) {
              using function_type = std::remove_reference_t<Body>;
              (*const_cast<function_type*>(static_cast<std::remove_const_t<function_type> const*>(function)))(i);
          }) {}

    /// Runs the function for index i.
    void operator()(std::size_t i) const { call_(body_, i); }

private:
    void const* body_;
    void (*call_)(void const*, std::size_t);
};

/// Runs `body(i)` once for every i in [0, count), in any order, possibly at once, and returns when all are done.
///
/// expression            | type | meaning
/// ----------------------|------|----------------------------------------------------------------------
/// `loop(count, body)`   | any  | calls `body(i)` once for each `i < count`; body is a loop_body, which
///                       |      | a std::function<void(std::size_t)> or a template parameter takes
///
/// These the compiler cannot check, and a model owes them (check_parallel_loop_laws of testing/parallel_loop_laws.hpp
/// checks them): every index is visited exactly once; nothing runs after the return; a body may run the loop itself; an
/// exception of the body reaches the caller (the first one; indices not yet begun may then be left out). Results of the
/// library do not depend on the model or on its number of threads. The library keeps a copy of a loop (any_loop); one
/// that cannot be copied is handed over as std::cref(loop).
template <class Loop>
concept parallel_loop = requires(Loop const& loop, std::size_t count, loop_body const& body) {
    loop(count, body);
};

/// The loop on the caller's thread, in order.
struct sequential_loop {
    /// Runs body(0), ..., body(count - 1).
    template <class Body>
    void operator()(std::size_t count, Body&& body) const {
        for (std::size_t i = 0; i < count; ++i) {
            body(i);
        }
    }
};

namespace detail {

/// Threads that sleep until a loop has work to share. Any number of loops may share at once, one inside the other too:
/// whoever shares works along, so nothing waits for a thread that is busy elsewhere.
class worker_pool {
public:
    /// Up to `workers` threads, which start with the first work.
    explicit worker_pool(std::size_t workers) : most_(workers) {}
    worker_pool(worker_pool const&) = delete;
    worker_pool& operator=(worker_pool const&) = delete;

    ~worker_pool() {
        {
            std::lock_guard const lock(mutex_);
            is_over_ = true;
        }
        work_is_there_.notify_all();
        for (auto& worker : workers_) {
            worker.join();
        }
    }

    /// Calls `work()` here and on up to `helpers` threads that are idle; returns when all these calls have returned.
    /// `work` does not throw.
    template <class Work>
    void share(Work const& work, std::size_t helpers) {
        job shared{[](void const* object) { (*static_cast<Work const*>(object))(); }, &work, helpers};
        {
            std::lock_guard const lock(mutex_);
            start_workers();
            jobs_.push_back(&shared);
        }
        for (std::size_t i = 0; i < helpers; ++i) {
            work_is_there_.notify_one();
        }
        work();
        std::unique_lock lock(mutex_);
        std::erase(jobs_, &shared); // Nobody joins any more.
        work_is_done_.wait(lock, [&] { return shared.running == 0; });
    }

private:
    struct job {
        void (*run)(void const*);
        void const* work;
        std::size_t wanted; ///< threads that may still join
        std::size_t running = 0;
    };

    void start_workers() {
        try {
            while (workers_.size() < most_) {
                workers_.emplace_back([this] { serve(); });
            }
        } catch (...) {
            most_ = workers_.size(); // A machine out of threads is slower, not wrong.
        }
    }

    void serve() {
        std::unique_lock lock(mutex_);
        for (;;) {
            work_is_there_.wait(lock, [this] { return is_over_ || !jobs_.empty(); });
            if (is_over_) {
                return;
            }
            auto& shared = *jobs_.front();
            ++shared.running;
            if (--shared.wanted == 0) {
                jobs_.erase(jobs_.begin());
            }
            lock.unlock();
            shared.run(shared.work);
            lock.lock();
            if (--shared.running == 0) {
                work_is_done_.notify_all();
            }
        }
    }

    std::size_t most_;
    std::mutex mutex_;
    std::condition_variable work_is_there_;
    std::condition_variable work_is_done_;
    std::vector<job*> jobs_;
    std::vector<std::thread> workers_;
    bool is_over_ = false;
};

} // namespace detail

/// The loop on `threads` threads, the caller's among them; indices are handed out one at a time, in order. The threads
/// start with the first loop and live as long as the last copy of this object; a loop inside a loop takes those that
/// are idle.
class threaded_loop {
public:
    /// 0 means as many threads as the machine has.
    explicit threaded_loop(std::size_t threads = 0)
        : threads_(threads > 0 ? threads : std::max<std::size_t>(1, std::thread::hardware_concurrency())),
          pool_(std::make_shared<detail::worker_pool>(threads_ - 1)) {}

    /// Number of threads that share a loop, the caller's included.
    std::size_t threads() const { return threads_; }

    /// Runs body(0), ..., body(count - 1), each once and in any order. What a body throws first ends the loop early and
    /// is thrown here, once no body runs any more.
    void operator()(std::size_t count, loop_body body) const {
        auto const workers = std::min(threads_, count);
        if (workers <= 1) {
            sequential_loop{}(count, body);
            return;
        }
        std::atomic<std::size_t> next{0};
        std::exception_ptr failure;
        std::mutex failure_mutex;
        auto const work = [&] {
            for (auto i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
                try {
                    body(i);
                } catch (...) {
                    std::lock_guard const lock(failure_mutex);
                    if (!failure) {
                        failure = std::current_exception();
                    }
                    next.store(count);
                }
            }
        };
        pool_->share(work, workers - 1);
        if (failure) {
            std::rethrow_exception(failure);
        }
    }

private:
    std::size_t threads_;
    std::shared_ptr<detail::worker_pool> pool_;
};

/// Any parallel_loop, so that what takes a loop is compiled once for all of them; itself a model. Copies share the loop.
class any_loop {
public:
    /// The loop on the caller's thread, in order.
    any_loop() = default;
    /// The loop on the caller's thread, in order.
    any_loop(sequential_loop) {}

    /// A copy of `loop`.
    template <parallel_loop Loop>
        requires(!std::is_same_v<Loop, any_loop> && !std::is_same_v<Loop, sequential_loop>)
    any_loop(Loop loop)
        : loop_(std::make_shared<Loop const>(std::move(loop))),
          run_([](void const* run, std::size_t count, loop_body body) {
              (*static_cast<Loop const*>(run))(count, body);
          }) {}

    /// Runs body(0), ..., body(count - 1) as the loop does that this was made of.
    void operator()(std::size_t count, loop_body body) const {
        if (run_ == nullptr) {
            sequential_loop{}(count, body);
        } else {
            run_(loop_.get(), count, body);
        }
    }

private:
    std::shared_ptr<void const> loop_;
    void (*run_)(void const*, std::size_t, loop_body) = nullptr;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
