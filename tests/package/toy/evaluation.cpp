// SPDX-License-Identifier: MIT
// A program of somebody who measures his runs: a mean with its error.
#include <genrender/evaluation.hpp>

#include <array>
#include <iostream>

int main() {
    std::array<double, 3> const scores{1, 2, 3};
    auto const of_runs = genrender::mean_and_error_of(scores);
    std::cout << of_runs.mean << " +- " << of_runs.error.value() << '\n';
    return of_runs.mean == 2 ? 0 : 1;
}
