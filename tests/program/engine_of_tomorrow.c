// SPDX-License-Identifier: MIT
// An engine of a header that is not written yet.
#include <genrender/c/engine.h>

genrender_engine const* genrender_engine_of(void);
genrender_engine const* genrender_engine_of(void) {
    static genrender_engine engine;
    engine.version = GENRENDER_ENGINE_VERSION + 1;
    return &engine;
}
