"""The RealSense camera: with a stand-in for its library, and with a recording where the library itself is there."""

import sys
import time
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from polyfold_pybullet.drivers.lens import straightening

from polyfold import plugins
from polyfold.errors import ConfigError, RobotError
from polyfold.plugins.hardware import DepthCamera

SIZE = (64, 48)
INTRINSICS = np.array([[60.0, 0.0, 31.5], [0.0, 60.0, 23.5], [0.0, 0.0, 1.0]])


class Library:
    """What the driver uses of ``pyrealsense2``, with pictures of its own."""

    def __init__(self, depths, coefficients=(0.0,) * 5, model="distortion.none"):
        self.depths, self.coefficients, self.model = depths, list(coefficients), model
        self.opened = self.closed = self.given = 0
        self.asked, self.fails = [], None
        self.stream = SimpleNamespace(depth="depth", color="color")
        self.format = SimpleNamespace(z16="z16", rgb8="rgb8")

    def pipeline(self):
        return self

    def config(self):
        library = self

        class Settings:
            def enable_device(self, serial):
                library.asked.append(serial)

            def enable_stream(self, *what):
                library.asked.append(what)

        return Settings()

    def start(self, settings):
        if self.fails == "open":
            raise RuntimeError("No device connected")
        self.opened += 1
        sensor = SimpleNamespace(get_depth_scale=lambda: 0.001)
        return SimpleNamespace(get_device=lambda: SimpleNamespace(first_depth_sensor=lambda: sensor))

    def stop(self):
        self.closed += 1

    def align(self, stream):
        assert stream == "color"
        return SimpleNamespace(process=lambda both: both)

    def wait_for_frames(self, patience):
        if self.fails == "die":
            raise RuntimeError(f"Frame didn't arrive within {patience}")
        self.given += 1
        depth = self.depths[self.given % len(self.depths)]
        lens = SimpleNamespace(fx=60.0, fy=60.0, ppx=31.5, ppy=23.5, model=self.model, coeffs=self.coefficients)
        profile = SimpleNamespace(as_video_stream_profile=lambda: SimpleNamespace(get_intrinsics=lambda: lens))
        colour = SimpleNamespace(get_data=lambda: np.full((48, 64, 3), 90, np.uint8), get_profile=lambda: profile)
        return SimpleNamespace(
            get_color_frame=lambda: colour, get_depth_frame=lambda: SimpleNamespace(get_data=lambda: depth)
        )


def flat(height):
    return np.full((48, 64), height, np.uint16)


@pytest.fixture
def library(monkeypatch):
    def install(*depths, **lens):
        made = Library(depths or (flat(900),), **lens)
        monkeypatch.setitem(sys.modules, "pyrealsense2", made)
        return made

    return install


def camera(**settings):
    from polyfold_pybullet.drivers.realsense import RealSense

    return RealSense(RealSense.Config(**settings))


def test_construction_opens_nothing_and_closing_releases(library):
    rs = library()
    made = camera(serial="0815")
    assert isinstance(made, DepthCamera)
    assert not rs.opened
    made.connect()
    made.connect()
    assert rs.opened == 1
    assert "0815" in rs.asked
    made.close()
    made.close()
    assert rs.closed == 1
    with pytest.raises(RobotError, match="call connect first"):
        made.get_rgbd()


def test_depth_is_the_median_in_metres_and_nan_where_it_was_mostly_missing(library):
    first, second, third = flat(900), flat(902), flat(950)
    first[0, 0] = second[0, 0] = 0
    first[1, 1] = 0
    library(first, second, third)
    made = camera()
    made.connect()
    frame = made.get_rgbd(3)
    assert frame.depth[20, 20] == pytest.approx(0.902)
    assert np.isnan(frame.depth[0, 0])
    assert frame.depth[1, 1] == pytest.approx(0.902)
    assert np.isnan(frame.extrinsics).all(), "it does not know where it stands"
    assert np.allclose(frame.intrinsics, INTRINSICS)


@pytest.mark.parametrize(("fails", "says"), [("open", "can't be opened .*plugged in"), ("die", "still plugged in")])
def test_a_camera_that_is_not_there_is_told_so_and_released(library, fails, says):
    rs = library()
    rs.fails = fails
    made = camera()
    with pytest.raises(RobotError, match=says):
        made.connect()
    assert rs.opened == rs.closed


def test_a_camera_that_dies_later_is_told_so(library):
    rs = library()
    made = camera()
    made.connect()
    rs.fails = "die"
    with pytest.raises(RobotError, match="gave no picture within 5 s"):
        made.get_rgbd()


def test_a_missing_recording_is_named(library):
    library()
    with pytest.raises(ConfigError, match=r"there is no recording lost.db3"):
        camera(recording="lost.db3").connect()


def test_pictures_are_straightened(library):
    bent = (-0.2, 0.05, 0.001, -0.002, 0.0)
    rs = library(coefficients=bent, model="distortion.brown_conrady")
    made = camera()
    made.connect()
    assert np.isfinite(made.get_rgbd().depth).all()
    rs.model = "distortion.kannala_brandt4"
    with pytest.raises(RobotError, match="kannala_brandt4"):
        made.get_rgbd()


def test_lenses_are_undone_as_opencv_does():
    bent = np.array([-0.2, 0.05, 0.001, -0.002, 0.01])
    found = straightening(INTRINSICS, bent, "brown-conrady", SIZE)
    across, down = cv2.initUndistortRectifyMap(INTRINSICS, bent, None, INTRINSICS, SIZE, cv2.CV_32FC1)
    assert found[..., 0] == pytest.approx(across, abs=1e-3)
    assert found[..., 1] == pytest.approx(down, abs=1e-3)
    assert straightening(INTRINSICS, bent, "none", SIZE) is None


def test_an_inverse_lens_is_turned_around():
    bent = np.array([-0.05, 0.02, 0.001, -0.002, 0.0])
    found = straightening(INTRINSICS, bent, "inverse-brown-conrady", SIZE)
    back = cv2.initUndistortRectifyMap(INTRINSICS, bent, None, INTRINSICS, SIZE, cv2.CV_32FC1)
    columns = np.indices((48, 64))[1]
    again = cv2.remap(back[0], found[..., 0].astype(np.float32), found[..., 1].astype(np.float32), cv2.INTER_LINEAR)
    inner = np.s_[8:-8, 8:-8]
    assert again[inner] == pytest.approx(columns[inner], abs=0.02)


def test_a_recording_of_the_real_library_is_played(tmp_path):
    rs = pytest.importorskip("pyrealsense2", exc_type=ImportError)
    path = _recorded(rs, tmp_path / "towel.db3")
    made = plugins.create("cameras", "realsense", {"recording": str(path)})
    made.connect()
    frame = made.get_rgbd(3)
    made.close()
    assert frame.depth.shape == (480, 640)
    assert frame.depth[10, 10] == pytest.approx(0.9)
    assert np.isnan(frame.depth[200, 200])
    assert frame.rgb[0, 0].tolist() == [200, 30, 30]
    assert frame.intrinsics[0].tolist() == [610.0, 0.0, 319.5]


def _recorded(rs, path):
    """A second of a camera that the library simulates."""
    device = rs.software_device()
    depth_sensor, colour_sensor = device.add_sensor("Depth"), device.add_sensor("Color")
    lens = rs.intrinsics()
    lens.width, lens.height, lens.ppx, lens.ppy, lens.fx, lens.fy = 640, 480, 319.5, 239.5, 610, 610
    lens.model, lens.coeffs = rs.distortion.none, [0] * 5

    def stream(kind, number, size, form):
        made = rs.video_stream()
        made.type, made.index, made.uid, made.width, made.height = kind, 0, number, 640, 480
        made.fps, made.bpp, made.fmt, made.intrinsics = 15, size, form, lens
        return made

    depth = depth_sensor.add_video_stream(stream(rs.stream.depth, 1, 2, rs.format.z16))
    colour = colour_sensor.add_video_stream(stream(rs.stream.color, 2, 3, rs.format.rgb8))
    depth_sensor.add_read_only_option(rs.option.depth_units, 0.001)
    same = rs.extrinsics()
    same.rotation, same.translation = [1, 0, 0, 0, 1, 0, 0, 0, 1], [0, 0, 0]
    depth.register_extrinsics_to(colour, same)
    device.create_matcher(rs.matchers.default)
    recorder, queue = rs.recorder(str(path), device), rs.syncer()
    sensors = recorder.query_sensors()
    for sensor in sensors:
        sensor.open(sensor.get_stream_profiles()[0])
        sensor.start(queue)
    heights = np.full((480, 640), 900, np.uint16)
    heights[190:210, 190:210] = 0
    for number in range(20):
        for sensor, profile, pixels, size in (
            (depth_sensor, depth, heights, 2),
            (colour_sensor, colour, np.full((480, 640, 3), (200, 30, 30), np.uint8), 3),
        ):
            frame = rs.software_video_frame()
            frame.stride, frame.bpp, frame.pixels = 640 * size, size, pixels
            frame.timestamp, frame.frame_number = number * 66.7, number
            frame.profile, frame.domain = profile.as_video_stream_profile(), rs.timestamp_domain.hardware_clock
            frame.depth_units = 0.001
            sensor.on_video_frame(frame)
        time.sleep(0.03)
    for sensor in sensors:
        sensor.stop()
        sensor.close()
    return path
