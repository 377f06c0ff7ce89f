// SPDX-License-Identifier: MIT
// What k-diffusion 0.1.1.post1 computes in double precision. Written by make_golden.py: change that, not this.
// clang-format off
#pragma once

#include <genrender/sampling/sampler.hpp>

#include <array>
#include <cstddef>

namespace genrender::golden {

/// [EDM eq. 5] Levels in Stable Diffusion's range, for a run of 1.
inline constexpr std::array<double, 2> karras_1 = {14.614599999999992, 0.0};

/// [EDM eq. 5] Levels in Stable Diffusion's range, for a run of 2.
inline constexpr std::array<double, 3> karras_2 = {14.614599999999992, 0.029200000000000004, 0.0};

/// [EDM eq. 5] Levels in Stable Diffusion's range, for a run of 10.
inline constexpr std::array<double, 11> karras_10 = {
    14.614599999999992, 9.103404833829892, 5.479026736168096, 3.1692041472211496, 1.7499009612035363,
    0.9144200047253521, 0.447144619920986, 0.20153187375743564, 0.08198091496087014, 0.029200000000000004, 0.0};

/// [EDM eq. 5] Levels in Stable Diffusion's range, for a run of 50.
inline constexpr std::array<double, 51> karras_50 = {
    14.614599999999992, 13.429325712583037, 12.327420480656526, 11.303939243347848, 10.35417443396746,
    9.473647320678628, 8.658099560264912, 7.903484962340379, 7.205961461347539, 6.561883293688024, 5.967793377330976,
    5.4204158912441205, 4.916649051992664, 4.453558084850713, 4.028368386770606, 3.6384588785547463,
    3.2813555435753066, 2.954725150386467, 2.656369156574462, 2.3842177911902307, 2.136324313109776,
    1.910859442667186, 1.7061059639053273, 1.5204534947891957, 1.3523934227269303, 1.2005140027434777,
    1.0634956156519078, 0.9401061835673732, 0.8291967401087096, 0.7296971526326718, 0.6406119938458009,
    0.5610165601389216, 0.49005303398925426, 0.42692678777515497, 0.37090282634846217, 0.3213023657094553,
    0.2774995451294161, 0.23891827006579347, 0.20502918321496058, 0.17534676104756583, 0.1494265331714676,
    0.12686242186725513, 0.10728419914134442, 0.09035505864164856, 0.07576929978081655, 0.0632501214120375,
    0.05254752240240363, 0.04343630644882983, 0.03571418848152311, 0.029200000000000004, 0.0};

/// Times, the ends of Stable Diffusion's 1000 steps among them.
inline constexpr std::array<double, 8> times = {0.0, 0.5, 1.0, 10.25, 499.0, 500.75, 998.5, 999.0};

/// The noise levels of these times.
inline constexpr std::array<double, 8> sigmas_of_times = {
    0.029167158151720367, 0.03471345544101747, 0.041314411996783096, 0.09940557007322762, 1.6128861943038755,
    1.6223370724047128, 14.570391470315318, 14.614641229333637};

/// Noise levels, some outside of Stable Diffusion's range.
inline constexpr std::array<double, 11> levels = {0.001, 0.0292, 0.03, 0.1, 0.5, 1.0, 2.5, 7.0, 14.0, 14.6146, 80.0};

/// The times of these noise levels.
inline constexpr std::array<double, 11> times_of_levels = {
    0.0, 0.0032322145275464147, 0.08086332679949673, 10.38219681104385, 169.31477055601414, 353.8904105949398,
    624.814483446278, 865.7471159899991, 991.8844178888768, 998.999534834261, 999.0};

/// Whose posterior mean the denoiser of a run is: N(0.7, 1.3^2); two equally likely points -1 and 1; two
/// equally likely clusters N(-1, 0.5^2) and N(1, 0.5^2).
enum class prior { gaussian, two_points, two_clusters };

/// One run over the Karras levels of `steps` steps.
struct run {
    prior of;
    sampler method;
    std::size_t steps;
    std::size_t evaluations;
    std::array<double, 4> last;
};

/// The latents that each run starts from.
inline constexpr std::array<double, 4> starts = {-22.0, -3.5, 0.25, 17.0};

/// The runs, each with what becomes of the starts.
inline constexpr std::array<run, 27> runs = {
    run{prior::gaussian, sampler::euler, 1, 1,
        {0.5217966471455213, 0.6670284545379381, 0.6964673344147791, 0.8279609978646683}},
    run{prior::gaussian, sampler::euler, 2, 2,
        {0.47691060566556887, 0.6587235481848188, 0.6955775230198021, 0.8601919439493924}},
    run{prior::gaussian, sampler::euler, 10, 10,
        {-1.009942686715723, 0.38362293902176053, 0.6661024577523313, 1.9278443080822145}},
    run{prior::gaussian, sampler::heun, 1, 1,
        {0.5217966471455213, 0.6670284545379381, 0.6964673344147791, 0.8279609978646683}},
    run{prior::gaussian, sampler::heun, 2, 3,
        {-10.727725283098675, -1.4143808893838747, 0.4734591904231702, 8.905811546894643}},
    run{prior::gaussian, sampler::heun, 10, 19,
        {-1.4152561733556457, 0.30863101638353685, 0.6580676088982361, 2.2188843887972265}},
    run{prior::gaussian, sampler::dpmpp_2m, 1, 1,
        {0.5217966471455228, 0.6670284545379381, 0.6964673344147791, 0.8279609978646687}},
    run{prior::gaussian, sampler::dpmpp_2m, 2, 2,
        {0.4769106056655676, 0.6587235481848186, 0.6955775230198021, 0.8601919439493944}},
    run{prior::gaussian, sampler::dpmpp_2m, 10, 10,
        {-1.4168935659724982, 0.30832806268350244, 0.6580351495732321, 2.2200601376806923}},
    run{prior::two_points, sampler::euler, 1, 1,
        {-0.10264001649608545, -0.016385334318990363, 0.001170485246104136, 0.07942538259477061}},
    run{prior::two_points, sampler::euler, 2, 2,
        {-1.0, -0.9999999999999999, 0.9607729009082919, 1.0}},
    run{prior::two_points, sampler::euler, 10, 10,
        {-1.0, -1.0, 1.0, 1.0}},
    run{prior::two_points, sampler::heun, 1, 1,
        {-0.10264001649608545, -0.016385334318990363, 0.001170485246104136, 0.07942538259477061}},
    run{prior::two_points, sampler::heun, 2, 3,
        {-1.0, -0.9999999999999716, 1.0, 1.0}},
    run{prior::two_points, sampler::heun, 10, 19,
        {-1.0, -1.0, 1.0, 1.0}},
    run{prior::two_points, sampler::dpmpp_2m, 1, 1,
        {-0.10264001649608705, -0.01638533431899054, 0.0011704852461041555, 0.07942538259476976}},
    run{prior::two_points, sampler::dpmpp_2m, 2, 2,
        {-1.0, -1.0, 0.9607729009082938, 1.0}},
    run{prior::two_points, sampler::dpmpp_2m, 10, 10,
        {-1.0, -1.0, 1.0, 1.0}},
    run{prior::two_clusters, sampler::euler, 1, 1,
        {-0.12812158405120044, -0.020438958085757797, 0.0014600293143563203, 0.0991151607191938}},
    run{prior::two_clusters, sampler::euler, 2, 2,
        {-0.1732590869181088, -0.027667698849618547, 0.001976473105253805, 0.134080579407844}},
    run{prior::two_clusters, sampler::euler, 10, 10,
        {-1.395041876597031, -0.43851892330285575, 0.03791693554948666, 1.2025701524973833}},
    run{prior::two_clusters, sampler::heun, 1, 1,
        {-0.12812158405120044, -0.020438958085757797, 0.0014600293143563203, 0.0991151607191938}},
    run{prior::two_clusters, sampler::heun, 2, 3,
        {-11.409411060848942, -1.8299385753914792, 0.132122253233101, 8.838761912060136}},
    run{prior::two_clusters, sampler::heun, 10, 19,
        {-1.6236993893292253, -0.590590528332725, 0.06679654271011337, 1.4028971817519738}},
    run{prior::two_clusters, sampler::dpmpp_2m, 1, 1,
        {-0.1281215840511987, -0.020438958085757814, 0.001460029314356325, 0.09911516071919255}},
    run{prior::two_clusters, sampler::dpmpp_2m, 2, 2,
        {-0.17325908691810685, -0.027667698849618574, 0.001976473105253832, 0.13408057940784465}},
    run{prior::two_clusters, sampler::dpmpp_2m, 10, 10,
        {-1.6328435198114701, -0.5896954737038902, 0.060168161875761655, 1.4167524588118763}}};

} // namespace genrender::golden
