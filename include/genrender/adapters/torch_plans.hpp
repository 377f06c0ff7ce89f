// SPDX-License-Identifier: MIT
// Plans of a run as tensors of LibTorch on their device, uploaded once; views of host memory as tensors.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/call_rows.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/plan_key.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/strided_view.hpp>

#include <ATen/core/Tensor.h>
#include <ATen/ops/from_blob.h>

#include <array>
#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <type_traits>
#include <vector>

namespace genrender::adapters {

/// The tensor in host memory that shares the elements of a view, with its extents and strides; it copies and owns nothing.
/// That of a view of const elements is not to be written. x0 and z of a denoiser's call become tensors by it:
/// `tensor_of(z).to(device)`, `tensor_of(x0).copy_(D)`.
template <class T, std::size_t Rank>
at::Tensor tensor_of(strided_view<T, Rank> const& view) {
    using scalar = std::remove_const_t<T>;
    std::array<std::int64_t, Rank> extents{};
    std::array<std::int64_t, Rank> strides{};
    for (std::size_t axis = 0; axis < Rank; ++axis) {
        extents[axis] = static_cast<std::int64_t>(view.extent(axis));
        strides[axis] = static_cast<std::int64_t>(view.strides()[axis]);
    }
    return at::from_blob(const_cast<scalar*>(view.data()), extents, strides,
                         at::TensorOptions().dtype(c10::CppTypeToScalarType<scalar>::value));
}

/// The plans of the frames of a call as tensors on a device, the arrays of call_rows.
struct torch_rows {
    at::Tensor offsets; ///< int32 [frames * tokens + 1]
    at::Tensor index;   ///< int32, row of F_KF; one per entry
    at::Tensor weights; ///< float32, alpha times the plan's; one per entry
    at::Tensor own;     ///< float32 [frames * tokens, 1], 1 - alpha, or 1 where no keyframe covers the token
};

/// What was uploaded of the plans of a run: plans that have keys are converted and uploaded once for all sites of their grid
/// and all branches, and dropped when plans of a later evaluation come. A handle, whose copies share what is uploaded; a
/// denoiser keeps one. May be used from several threads at once.
class torch_plans {
public:
    /// The plans as they are handed to `mix`, on the device. Throws as make_call_rows does.
    torch_rows rows(std::span<sparse_rows<float> const> plans, float alpha, at::Device device) const {
        require_value(is_finite(alpha), "torch_plans", "alpha", alpha, "a finite number"); // also as a key
        place_of_plans place{{}, alpha, static_cast<int>(device.type()), device.index()};
        for (auto const& plan : plans) {
            if (!plan.key) {
                return uploaded(plans, alpha, device);
            }
            place.keys.push_back(*plan.key);
        }
        std::lock_guard const lock(shared_->mutex);
        if (auto const found = shared_->kept.find(place); found != shared_->kept.end()) {
            return found->second;
        }
        std::erase_if(shared_->kept, [&](auto const& old) { return old.first.evaluation() < place.evaluation(); });
        return shared_->kept.emplace(place, uploaded(plans, alpha, device)).first->second;
    }

    /// How many times the plans of a call were uploaded so far.
    std::size_t uploads() const { return shared_->uploads; }

private:
    struct place_of_plans {
        std::vector<plan_key> keys;
        float alpha;
        int device;
        int number;
        auto operator<=>(place_of_plans const&) const = default;
        std::uint64_t evaluation() const { return keys.empty() ? 0 : keys.front().evaluation; }
    };
    struct shared_plans {
        std::mutex mutex;
        std::map<place_of_plans, torch_rows> kept;
        std::atomic<std::size_t> uploads{0};
    };

    torch_rows uploaded(std::span<sparse_rows<float> const> plans, float alpha, at::Device device) const {
        auto const rows = make_call_rows<float>(plans, alpha);
        ++shared_->uploads;
        auto const upload = [&]<class T>(std::vector<T> const& values) {
            auto const here = tensor_of(strided_view<T const, 1>(values.data(), {values.size()}));
            return here.to(device, here.scalar_type(), false, true);
        };
        return {upload(rows.offsets), upload(rows.index), upload(rows.weights), upload(rows.own).unsqueeze(1)};
    }

    std::shared_ptr<shared_plans> shared_ = std::make_shared<shared_plans>();
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
