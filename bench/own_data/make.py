#!/usr/bin/python3
"""Makes a lab's files of a recording: make.py KIND RECORDING FOLDER, KIND one of csv, video, rosbag,
mcap, dvrk. Needs Debian's python3-rosbag, python3-geometry-msgs (rosbag), ffmpeg (video, dvrk), and
@mcap/core of npm (mcap, dvrk)."""
import csv
import json
import os
import struct
import subprocess
import sys


def rows(recording, stream):
    """Returns the header and rows of a stream's table."""
    with open(os.path.join(recording, stream, 'data.csv')) as file:
        table = list(csv.reader(file))
    return table[0], table[1:]


def has(recording, stream):
    return os.path.exists(os.path.join(recording, stream, 'data.csv'))


def write_csv(recording, folder):
    """A robot's log in millimetres with x y z w, decimal commas and seconds; a tracker's table."""
    t0 = int(rows(recording, 'wrist0')[1][0][0])
    with open(os.path.join(folder, 'robot.csv'), 'w') as out:
        out.write('\ufefftime [s];x [mm];y [mm];z [mm];qx;qy;qz;qw\r\n')
        for t, x, y, z, qw, qx, qy, qz in rows(recording, 'wrist0')[1]:
            cells = [f'{(int(t) - t0) / 1e9 + 12.3:.4f}']
            cells += [f'{1e3 * float(v):.4f}' for v in (x, y, z)] + [qx, qy, qz, qw]
            out.write(';'.join(c.replace('.', ',') for c in cells) + '\r\n')
    if has(recording, 'em0'):
        with open(os.path.join(folder, 'aurora.csv'), 'w') as out:
            out.write('Time,Tool,State,Q0,Qx,Qy,Qz,Tx,Ty,Tz\n')
            for t, x, y, z, *q in rows(recording, 'em0')[1]:
                place = [f'{1e3 * float(v):.5f}' for v in (x, y, z)]
                out.write(','.join([f'{(int(t) - t0) / 1e9 + 12.3:.4f}', '1', 'OK', *q, *place]) + '\n')
    if has(recording, 'load0'):
        with open(os.path.join(folder, 'force.csv'), 'w') as out:
            out.write('t_s,fx,fy,fz\n')
            for t, *f in rows(recording, 'load0')[1]:
                out.write(','.join([f'{(int(t) - t0) / 1e9 + 12.3:.4f}', *f]) + '\n')


def write_video(recording, folder, name='scope.mp4', side_car='frames.txt'):
    """The frames as a lossless video, their times in a file of their own, the wrist as a table."""
    camera = os.path.join(recording, 'cam0')
    frames = rows(recording, 'cam0')[1]
    listing = os.path.join(folder, 'list.txt')
    with open(listing, 'w') as out:
        for _, picture in frames:
            out.write(f"file '{os.path.abspath(os.path.join(camera, 'data', picture))}'\n")
    subprocess.run(['ffmpeg', '-v', 'error', '-y', '-r', '25', '-f', 'concat', '-safe', '0', '-i',
                    listing, '-c:v', 'libx264', '-qp', '0', '-r', '25',
                    os.path.join(folder, name)], check=True)
    os.remove(listing)
    if side_car:
        with open(os.path.join(folder, side_car), 'w') as out:
            out.writelines(f'{int(t) / 1e9:.6f}\n' for t, _ in frames)
        with open(os.path.join(folder, 'robot.csv'), 'w') as out:
            out.write('timestamp,pos_x,pos_y,pos_z,qw,qx,qy,qz\n')
            for t, *values in rows(recording, 'wrist0')[1]:
                out.write(','.join([f'{int(t) / 1e9:.6f}', *values]) + '\n')
    return frames


def poses(recording):
    """Yields topic, time and pose (place, quaternion x y z w) or force in the order of time."""
    messages = []
    for topic, stream in (('/PSM1/measured_cp', 'wrist0'), ('/aurora/tip', 'em0')):
        if not has(recording, stream):
            continue
        for t, x, y, z, qw, qx, qy, qz in rows(recording, stream)[1]:
            messages.append((int(t), topic, [float(v) for v in (x, y, z, qx, qy, qz, qw)]))
    if has(recording, 'load0'):
        for t, *f in rows(recording, 'load0')[1]:
            messages.append((int(t), '/ft_sensor/wrench', [float(v) for v in f]))
    return sorted(messages)


def write_rosbag(recording, folder):
    import genpy
    import rosbag
    from geometry_msgs.msg import PoseStamped, WrenchStamped
    with rosbag.Bag(os.path.join(folder, 'session.bag'), 'w') as bag:
        for t_ns, topic, v in poses(recording):
            stamp = genpy.Time(t_ns // 10**9, t_ns % 10**9)
            if len(v) == 3:
                m = WrenchStamped()
                m.wrench.force.x, m.wrench.force.y, m.wrench.force.z = v
            else:
                m = PoseStamped()
                place, turn = m.pose.position, m.pose.orientation
                place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = v
            m.header.stamp = stamp
            bag.write(topic, m, stamp)


def cdr(t_ns, values):
    """A header with an empty frame and doubles, as ROS 2 lays them out."""
    body = struct.pack('<iI', t_ns // 10**9, t_ns % 10**9) + struct.pack('<I', 1) + b'\0'
    body += b'\0' * (-len(body) % 8)
    return b'\0\1\0\0' + body + struct.pack(f'<{len(values)}d', *values)


DEFINITIONS = {
    'geometry_msgs/msg/PoseStamped': ('std_msgs/Header header\ngeometry_msgs/Pose pose', ('Pose',)),
    'geometry_msgs/msg/WrenchStamped':
        ('std_msgs/Header header\ngeometry_msgs/Wrench wrench', ('Wrench',))}
PARTS = '\n'.join('=' * 80 + f'\nMSG: {name}\n{text}' for name, text in (
    ('std_msgs/Header', 'builtin_interfaces/Time stamp\nstring frame_id'),
    ('builtin_interfaces/Time', 'int32 sec\nuint32 nanosec'),
    ('geometry_msgs/Pose', 'geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation'),
    ('geometry_msgs/Point', 'float64 x\nfloat64 y\nfloat64 z'),
    ('geometry_msgs/Quaternion', 'float64 x\nfloat64 y\nfloat64 z\nfloat64 w'),
    ('geometry_msgs/Wrench', 'geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque'),
    ('geometry_msgs/Vector3', 'float64 x\nfloat64 y\nfloat64 z')))


def write_mcap(recording, folder, name='session.mcap'):
    messages = []
    for t_ns, topic, v in poses(recording):
        kind = 'geometry_msgs/msg/' + ('WrenchStamped' if len(v) == 3 else 'PoseStamped')
        values = v + [0.0, 0.0, 0.0] if len(v) == 3 else v
        messages.append({'topic': topic, 'type': kind, 't_ns': str(t_ns),
                         'data': cdr(t_ns, values).hex()})
    schemas = {kind: text + '\n' + PARTS for kind, (text, _) in DEFINITIONS.items()}
    writer = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'write_mcap.mjs')
    subprocess.run(['node', writer, os.path.join(folder, name)], check=True,
                   input=json.dumps({'schemas': schemas, 'messages': messages}).encode())


def write_dvrk(recording, folder):
    os.makedirs(os.path.join(folder, 'rosbag_1'))
    write_mcap(recording, folder, 'rosbag_1/rosbag_1_0.mcap')
    frames = write_video(recording, folder, 'left.mp4', side_car='')
    with open(os.path.join(folder, 'left.json'), 'w') as out:
        json.dump({'type': 'dvrk_data:sidecar@1.0.0', 'estimated_latency': 0.0,
                   'frames': [{'cpu_ns': int(t), 'gst_ns': 0} for t, _ in frames]}, out)
    with open(os.path.join(folder, 'index.json'), 'w') as out:
        json.dump({'type': 'dvrk_data:index@1.0.0', 'rosbags': 'rosbag_1', 'streams': [
            {'name': 'left', 'videos': [{'file': 'left.mp4', 'frames': len(frames)}]}]}, out)


KINDS = {'csv': write_csv, 'video': write_video, 'rosbag': write_rosbag, 'mcap': write_mcap,
         'dvrk': write_dvrk}

if __name__ == '__main__':
    if len(sys.argv) != 4 or sys.argv[1] not in KINDS:
        sys.exit(__doc__)
    os.makedirs(sys.argv[3])
    KINDS[sys.argv[1]](sys.argv[2], sys.argv[3])
