// SPDX-License-Identifier: MIT
// An instance that is compiled elsewhere is called like one that is compiled here.
#include <genrender/core/instance.hpp>

#include <doctest/doctest.h>

namespace instance_test {

template <class Real>
class doubled {
public:
    explicit doubled(Real value) : value_(value) {}
    Real result() const;

private:
    Real value_;
};

template <class Real>
Real doubled<Real>::result() const {
    return 2 * value_;
}

template <class Real>
Real tripled(Real value) {
    return 3 * value;
}

GENRENDER_INSTANCE(tripled<float>);
GENRENDER_CLASS_INSTANCE(doubled<float>);

// Where they are declared as compiled elsewhere, elsewhere is here.
template float tripled<float>(float);
template class doubled<float>;

} // namespace instance_test

TEST_SUITE("core/instance") {
    TEST_CASE("a declared instance and one that is made where it is called give the same") {
        using namespace instance_test;
        CHECK(tripled(1.5F) == 4.5F);
        CHECK(tripled(1.5) == 4.5);
        CHECK(doubled<float>(1.5F).result() == 3);
        CHECK(doubled<double>(1.5).result() == 3);
    }
}
