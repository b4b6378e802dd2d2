"""Keys of an animation: as many as its error needs, and no more."""

import numpy as np
import pinocchio as pin
import pytest
from meshcat.path import Path as ScenePath

from ospace.visual import animation
from ospace.visual.animation import ERROR, keys_of

TIME = np.linspace(0.0, 10.0, 5001)


def columns(*of_time):
    return np.column_stack(np.broadcast_arrays(TIME * 0.0, *of_time)[1:])


CURVES = {
    "smooth": columns(np.sin(3.0 * TIME), np.cos(2.0 * TIME), 0.3 * TIME**2),
    "kinked": columns(np.abs(TIME - 3.3), np.maximum(0.0, TIME - 7.0), 0.0),
    "constant": columns(1.0, -2.0, 3.0),
    "a step": columns(np.where(TIME > 5.0, 1.0, 0.0), 0.0, 0.0),
    "rest, motion, rest": columns(
        np.clip(TIME - 4.0, 0.0, 1.0) ** 2 * (3 - 2 * np.clip(TIME - 4.0, 0.0, 1.0)), 0.0, 0.0
    ),
    "noise": np.random.default_rng(1).normal(size=(len(TIME), 3)),
    "a line": columns(TIME, -2.0 * TIME, 0.0),
}


def between_keys(X, keys):
    """Return straight lines between keys, at all times."""
    return np.column_stack([np.interp(TIME, TIME[keys], column[keys]) for column in X.T])


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("error", [1e-2, 1e-4, ERROR])
def test_straight_lines_keep_the_error(name, error):
    X = CURVES[name]
    keys = keys_of(TIME, X, animation._line, error)
    assert keys[0] == 0
    assert keys[-1] == len(TIME) - 1
    assert (np.diff(keys) > 0).all()
    assert np.abs(between_keys(X, keys) - X).max() <= error


@pytest.mark.parametrize(
    ("name", "most"), [("constant", 2), ("a line", 4), ("kinked", 20), ("rest, motion, rest", 200)]
)
def test_a_body_at_rest_takes_few_keys(name, most):
    assert len(keys_of(TIME, CURVES[name], animation._line, 1e-4)) <= most


def test_fewer_keys_where_more_error_is_allowed():
    counts = [len(keys_of(TIME, CURVES["smooth"], animation._line, error)) for error in (1e-5, 1e-3, 1e-1)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] / counts[1] == pytest.approx(10.0, rel=0.6)  # by the root of the error


@pytest.mark.parametrize("records", [1, 2, 3])
def test_few_records_are_all_kept(records):
    X = np.arange(3.0 * records).reshape(records, 3) ** 2
    assert keys_of(np.arange(float(records)), X, animation._line, 1e-6).tolist() == list(range(records))


def turning(angles, axis=(0.6, 0.0, 0.8)):
    half = 0.5 * np.asarray(angles)[:, None]
    return np.hstack([np.sin(half) * np.array(axis), np.cos(half)])


def test_quaternions_go_along_arcs():
    """A steady turn is one arc from key to key, over less than half a turn each; a wobble takes what it takes."""
    Q = turning(0.25 * TIME)
    keys = keys_of(TIME, Q, animation._arc, ERROR)
    assert len(keys) < 10
    assert (np.sum(Q[keys[1:]] * Q[keys[:-1]], axis=1) > 0.0).all()
    Q = turning(np.sin(TIME))
    keys = keys_of(TIME, Q, animation._arc, ERROR)
    after = np.clip(np.searchsorted(keys, np.arange(len(TIME)), side="right"), 1, len(keys) - 1)
    worst = 0.0
    for k in range(0, len(TIME), 37):
        a, b = keys[after[k] - 1], keys[after[k]]
        share = (TIME[k] - TIME[a]) / (TIME[b] - TIME[a])
        shown = pin.Quaternion(Q[a]).slerp(share, pin.Quaternion(Q[b])).coeffs()
        worst = max(worst, np.abs(shown - Q[k]).max())
    assert worst <= ERROR
    assert len(keys) < len(TIME)


def test_signs_of_quaternions_make_no_jump():
    Q = turning(3.0 * TIME)
    flipped = Q * np.where(np.random.default_rng(3).random(len(TIME)) < 0.5, -1.0, 1.0)[:, None]
    pose = np.hstack([np.zeros((len(TIME), 3)), flipped])
    made, error = animation.animation({"/a": (TIME, pose)})
    (clip,) = made.clips.values()
    track = clip.tracks["quaternion"]
    values = np.array(track.values)
    assert error < 1.3 * ERROR  # and single precision
    assert (np.sum(values[1:] * values[:-1], axis=1) > 0.0).all()
    straight, _ = animation.animation({"/a": (TIME, np.hstack([np.zeros((len(TIME), 3)), Q]))})
    (other,) = straight.clips.values()
    assert track.frames == other.tracks["quaternion"].frames


def test_tracks_are_those_of_the_motion():
    pose = np.hstack([CURVES["smooth"], turning(np.sin(TIME)), np.ones((len(TIME), 3))])
    made, _ = animation.animation(
        {"/robots/0 a/joint b": (TIME, pose), "/rests": (TIME, np.tile(pose[0, :7], (len(TIME), 1)))}
    )
    assert list(made.clips) == [ScenePath(("robots", "0 a", "joint b")), ScenePath(("rests",))]
    moving, resting = made.clips.values()
    assert set(moving.tracks) == {"position", "quaternion", "scale"}
    assert set(resting.tracks) == {"position", "quaternion"}
    assert all(
        track.frames[0] == 0 and track.frames[-1] == 10 * made.default_framerate for track in moving.tracks.values()
    )
    assert all(len(track.frames) == 2 for track in resting.tracks.values())
    np.testing.assert_array_equal(resting.tracks["position"].values[0], pose[0, :3].astype(np.float32))


@pytest.mark.parametrize("duration", [0.3, 91.0, 200.0, 5000.0])
def test_single_precision_has_every_time(duration):
    """As three.js keeps them; else a body is off by what it moves in the rounding of its time."""
    time = np.linspace(0.0, duration, 4001)
    pose = np.hstack([0.5 * np.column_stack([np.sin(time), np.cos(time), time * 0.0]), turning(0.0 * time)])
    made, error = animation.animation({"/a": (time, pose)})
    (clip,) = made.clips.values()
    frames = np.array(clip.tracks["position"].frames)
    times = frames.astype(np.float32).astype(np.float64)
    np.testing.assert_array_equal(times, frames)
    assert made.default_framerate == 1
    shown = np.column_stack([np.interp(time, times, column) for column in np.array(clip.tracks["position"].values).T])
    off = np.linalg.norm(shown - pose[:, :3], axis=1).max()
    assert off <= error + 1e-12
    if duration < 100.0:
        assert error < 1.5 * ERROR


def test_too_many_keys_cost_precision(monkeypatch):
    monkeypatch.setattr(animation, "_MOST_KEYS", 200)
    pose = np.hstack([CURVES["smooth"], turning(np.sin(TIME))])
    made, error = animation.animation({"/a": (TIME, pose)})
    (clip,) = made.clips.values()
    assert sum(len(track.frames) for track in clip.tracks.values()) <= 200
    assert error > ERROR
    frames = np.array(clip.tracks["position"].frames)
    shown = np.column_stack(
        [
            np.interp(TIME * made.default_framerate, frames, column)
            for column in np.array(clip.tracks["position"].values).T
        ]
    )
    assert np.abs(shown - CURVES["smooth"]).max() <= error
