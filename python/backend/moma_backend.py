"""How pip builds the package: as scikit-build-core does, and from a checkout that cannot be written to as well."""

import os
import pathlib

from scikit_build_core import build
from scikit_build_core.build import *  # noqa: F403

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]


def _settings(given):
    if os.access(CHECKOUT, os.W_OK):
        return given
    cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache")
    return {"build-dir": str(cache / "moma" / "build-wheel"), "cmake.define.MOMA_REUSE_BUILD": "OFF", **(given or {})}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return build.build_wheel(wheel_directory, _settings(config_settings), metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    return build.build_editable(wheel_directory, _settings(config_settings), metadata_directory)
