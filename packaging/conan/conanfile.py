# SPDX-License-Identifier: MIT
"""The Conan recipe of the tree that it lies in; packaging/README.md says how to use it."""
import re
from pathlib import Path

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load
from conan.tools.system.package_manager import Apt

required_conan_version = ">=2.0"

# What each component needs, as in cmake/components.cmake: the package of Conan and that of Debian and Ubuntu.
PACKAGES = {
    "core": {
        "eigen/[>=3.4 <6]": "libeigen3-dev",
        "xtensor/[>=0.24 <1]": "libxtensor-dev",
        "nanoflann/[>=1.3 <2]": "libnanoflann-dev",
    },
    "scene": {"glm/[>=0.9.9]": "libglm-dev"},
    "inspection": {},
    "evaluation": {},
    "c": {},
    "reference": {
        "nlohmann_json/[>=3.10 <4]": "nlohmann-json3-dev",
        "utf8proc/[>=2.4 <3]": "libutf8proc-dev",
    },
}


class GenrenderRecipe(ConanFile):
    name = "genrender"
    description = (
        "The algorithmic core of Generative Rendering: consistent frames from UV and depth maps and any 2D diffusion network"
    )
    license = "MIT"
    topics = ("diffusion", "rendering", "animation", "video", "header-only")
    package_type = "header-library"
    settings = "os", "arch", "compiler", "build_type"
    options = {
        "scene": [True, False],
        "reference": [True, False],
        # Eigen and the others are those of the system, installed by its package manager, and not packages of Conan.
        "system_packages": [True, False],
    }
    default_options = {"scene": True, "reference": True, "system_packages": False}
    no_copy_source = True

    def _components(self):
        return [name for name in PACKAGES if self.options.get_safe(name, True)]

    def set_version(self):
        header = load(self, Path(self.recipe_folder) / "../../include/genrender/version.hpp")
        self.version = re.search(r'^#define GENRENDER_VERSION_STRING "(.+)"', header, re.MULTILINE).group(1)

    def export_sources(self):
        root = Path(self.recipe_folder) / "../.."
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "include/*"):
            copy(self, pattern, root, self.export_sources_folder)

    def requirements(self):
        if not self.options.system_packages:
            for component in self._components():
                for package in PACKAGES[component]:
                    self.requires(package, transitive_headers=True)

    def system_requirements(self):
        if self.options.system_packages:
            debian = [name for component in self._components() for name in PACKAGES[component].values()]
            Apt(self).install(debian, check=True)

    def validate(self):
        check_min_cppstd(self, 20)

    def package_id(self):
        self.info.settings.clear()
        self.info.requires.clear()

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["GENRENDER_BUILD_TESTS"] = False
        toolchain.cache_variables["GENRENDER_BUILD_EXAMPLES"] = False
        toolchain.cache_variables["GENRENDER_COMPONENTS"] = ";".join(self._components()[1:])
        toolchain.generate()

    def build(self):
        CMake(self).configure()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, Path(self.package_folder) / "licenses")

    def package_info(self):
        # CMake finds the config file that is installed, which looks for the packages of the components asked for.
        self.cpp_info.set_property("cmake_find_mode", "none")
        for name in self._components():
            component = self.cpp_info.components[name]
            component.set_property("pkg_config_name", "genrender" if name == "core" else f"genrender-{name}")
            component.bindirs = []
            component.libdirs = []
            component.builddirs = ["share/cmake/genrender"]
            if name != "core":
                component.requires = ["core"]
            elif self.settings.os in ("Linux", "FreeBSD"):
                component.system_libs = ["pthread"]
            if not self.options.system_packages:
                packages = [package.partition("/")[0] for package in PACKAGES[name]]
                component.requires += [f"{package}::{package}" for package in packages]
