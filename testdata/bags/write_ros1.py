#!/usr/bin/python3
"""Writes the bag of ROS 1 beside this file with Debian's python3-rosbag, and python3-geometry-msgs
and python3-sensor-msgs: another program than the one that reads them."""
import math
import os

import genpy
import rosbag
from geometry_msgs.msg import PoseStamped, TransformStamped, WrenchStamped
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, JointState

HERE = os.path.dirname(os.path.abspath(__file__))
START_NS = 1700000000123456789
STEP_NS = 20000000
COUNT = 40
JOINTS = ['yaw', 'pitch', 'insertion']


def time(ns):
    return genpy.Time(ns // 10**9, ns % 10**9)


def pose(message, k, offset):
    """The motion that the test knows: a place, and a turn about z."""
    place = message.pose.position if hasattr(message, 'pose') else message.transform.translation
    turn = message.pose.orientation if hasattr(message, 'pose') else message.transform.rotation
    place.x = 0.1 + 0.01 * math.sin(0.3 * k) + offset
    place.y = -0.02 * k / COUNT
    place.z = 0.05 * math.cos(0.2 * k)
    turn.z = math.sin(0.01 * k)
    turn.w = math.cos(0.01 * k)
    return message


def messages():
    """Yields topic, message and the recorder's time, in the order of recording."""
    for k in range(COUNT):
        stamp = START_NS + k * STEP_NS
        received = stamp + 1500000
        for arm, offset in (('PSM1', 0.0), ('PSM2', 0.5)):
            m = pose(PoseStamped(), k, offset)
            m.header.frame_id = arm + '_base'
            yield '/%s/measured_cp' % arm, m, stamp, received
        m = pose(PoseStamped(), k + 1, 0.0)
        yield '/PSM1/setpoint_cp', m, stamp, received
        m = pose(TransformStamped(), k, -0.2)
        m.header.frame_id, m.child_frame_id = 'aurora', 'tool'
        yield '/aurora/tool', m, stamp + 7000000, received
        m = WrenchStamped()
        m.wrench.force.x, m.wrench.force.y, m.wrench.force.z = 0.1 * k, -0.2, 0.3 * math.sin(k)
        yield '/ft_sensor/wrench', m, stamp, received
        m = JointState(name=JOINTS, position=[0.01 * k, -0.02 * k, 0.1 + 0.001 * k],
                       effort=[0.5, 0.25 * k, 1.0])
        yield '/PSM1/measured_js', m, stamp, received
        if k % 10 == 0:
            m = Image(height=6, width=8, encoding='rgb8', step=24)
            m.data = bytes((3 * x + 5 * y + 7 * c + k) % 256
                           for y in range(6) for x in range(8) for c in range(3))
            yield '/endoscope/left/image_raw', m, stamp, received
            m = CompressedImage(format='png', data=open(os.path.join(HERE, 'grey.png'), 'rb').read())
            yield '/endoscope/right/image_raw/compressed', m, stamp, received
            for side, model, d in (('left', 'plumb_bob', [0.1, -0.2, 0.001, 0.002, 0.0]),
                                   ('right', 'equidistant', [0.1, 0.2, 0.3, 0.4])):
                m = CameraInfo(height=6, width=8, distortion_model=model, D=d,
                               K=[7, 0, 3.5, 0, 7.5, 2.5, 0, 0, 1],
                               R=[1, 0, 0, 0, 1, 0, 0, 0, 1],
                               P=[7, 0, 3.5, 0, 0, 7.5, 2.5, 0, 0, 0, 1, 0])
                yield '/endoscope/%s/camera_info' % side, m, stamp, received


with rosbag.Bag(os.path.join(HERE, 'ros1_lz4.bag'), 'w', compression='lz4',
                chunk_threshold=8192) as bag:
    for topic, message, stamp, received in messages():
        message.header.stamp = time(stamp)
        bag.write(topic, message, time(received))
