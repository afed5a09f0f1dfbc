// One axis over a simulated drive, called from C#: power on, there and back, power off. Prints the axis scan by scan, every bit of
// it, when it is asked to with any argument; the lines are those of single_axis.c.
using System;
using System.Runtime.InteropServices;

static class SingleAxis
{
    // Structures as in standstill.h and standstill_blocks.h; each begins with its size.
    [StructLayout(LayoutKind.Sequential)]
    struct RuntimeConfig
    {
        public uint Size, Axes, Instances, Reserved;
        public long CycleNs;
    }

    // What is not named here is filled in by standstill_axis_defaults.
    [StructLayout(LayoutKind.Sequential, Size = 376)]
    struct AxisSetup
    {
        public uint Size, StartPowered;
        public double Velocity, Acceleration, Deceleration, Jerk, Snap;
    }

    [StructLayout(LayoutKind.Sequential, Size = 248)]
    struct DriveSetup
    {
        public uint Size;
    }

    [StructLayout(LayoutKind.Sequential)]
    struct AxisStatus
    {
        public uint Size;
        public int State;
        public double Position, Velocity, Acceleration, Jerk, Snap, ActualPosition;
        public uint ErrorId, ErrorCode, Powered, Homed;
    }

    [StructLayout(LayoutKind.Sequential, Size = 16)]
    struct PowerIn
    {
        public uint Size;
        public int Axis;
        public byte Enable, EnablePositive, EnableNegative;
    }

    [StructLayout(LayoutKind.Sequential, Size = 16)]
    struct PowerOut
    {
        public uint Size;
        public byte Status, Valid, Error, Reserved;
        public ushort ErrorId;
    }

    [StructLayout(LayoutKind.Sequential, Size = 72)]
    struct MoveAbsoluteIn
    {
        public uint Size;
        public int Axis;
        public byte Execute, ContinuousUpdate, Reserved2, Reserved3, Reserved4, Reserved5, Reserved6, Reserved7;
        public double Position, Velocity, Acceleration, Deceleration, Jerk;
        public int Direction, BufferMode;
        public double Snap;
    }

    [StructLayout(LayoutKind.Sequential, Size = 16)]
    struct MoveAbsoluteOut
    {
        public uint Size;
        public byte Done, Busy, Active, CommandAborted, Error, Reserved;
        public ushort ErrorId;
    }

    // libstandstill_capi.so, standstill_capi.dll or libstandstill_capi.dylib, where the system looks for libraries.
    const string Library = "standstill_capi";

    [DllImport(Library)] static extern uint standstill_abi_version();
    [DllImport(Library)] static extern IntPtr standstill_result_text(int result);
    [DllImport(Library)] static extern int standstill_runtime_size(ref RuntimeConfig config, out UIntPtr bytes);
    [DllImport(Library)] static extern int standstill_runtime_init(uint abi, IntPtr storage, UIntPtr bytes, ref RuntimeConfig config, out IntPtr runtime);
    [DllImport(Library)] static extern int standstill_runtime_close(IntPtr runtime);
    [DllImport(Library)] static extern int standstill_axis_defaults(ref AxisSetup setup);
    [DllImport(Library)] static extern int standstill_drive_defaults(ref DriveSetup setup);
    [DllImport(Library)] static extern int standstill_axis_add(IntPtr runtime, ref AxisSetup setup, ref DriveSetup drive, out int axis);
    [DllImport(Library)] static extern int standstill_tick_begin(IntPtr runtime, long nowNs);
    [DllImport(Library)] static extern int standstill_tick_end(IntPtr runtime);
    [DllImport(Library)] static extern int standstill_axis_read(IntPtr runtime, int axis, ref AxisStatus status);
    [DllImport(Library)] static extern int standstill_mc_power(IntPtr runtime, ref ulong key, ref PowerIn input, ref PowerOut output);
    [DllImport(Library)] static extern int standstill_mc_move_absolute(IntPtr runtime, ref ulong key, ref MoveAbsoluteIn input, ref MoveAbsoluteOut output);

    // STANDSTILL_ABI_VERSION of the headers that these structures were written after.
    const uint AbiVersion = 1;

    static void Check(int result, string what)
    {
        if (result == 0) return;
        string text = Marshal.PtrToStringAnsi(standstill_result_text(result));
        throw new InvalidOperationException(what + ": " + text);
    }

    static uint SizeOf<T>() => (uint)Marshal.SizeOf(typeof(T));

    static string Bits(double value) => BitConverter.DoubleToInt64Bits(value).ToString("x16");

    static int Main(string[] args)
    {
        var config = new RuntimeConfig { Size = SizeOf<RuntimeConfig>(), Axes = 1, Instances = 16, CycleNs = 1000000 };
        UIntPtr bytes;
        Check(standstill_runtime_size(ref config, out bytes), "runtime_size");
        // Aligned to 16 bytes, and kept until runtime_close.
        IntPtr memory = Marshal.AllocHGlobal((int)bytes.ToUInt64() + 15);
        IntPtr storage = new IntPtr((memory.ToInt64() + 15) & ~15L);
        IntPtr rt;
        Check(standstill_runtime_init(AbiVersion, storage, bytes, ref config, out rt), "runtime_init");

        var setup = new AxisSetup { Size = SizeOf<AxisSetup>() };
        Check(standstill_axis_defaults(ref setup), "axis_defaults");
        setup.Velocity = 50.0;
        setup.Acceleration = 1000.0;
        setup.Jerk = 50000.0;
        setup.Snap = 5000000.0;
        var drive = new DriveSetup { Size = SizeOf<DriveSetup>() };
        Check(standstill_drive_defaults(ref drive), "drive_defaults");
        int axis;
        Check(standstill_axis_add(rt, ref setup, ref drive, out axis), "axis_add");

        // The program: instances are keys, 0 until they are first called.
        ulong powerKey = 0, thereKey = 0, backKey = 0;
        var power = new PowerIn { Size = SizeOf<PowerIn>(), Axis = axis, EnablePositive = 1, EnableNegative = 1 };
        var powered = new PowerOut { Size = SizeOf<PowerOut>() };
        var there = new MoveAbsoluteIn { Size = SizeOf<MoveAbsoluteIn>(), Axis = axis, Position = 4.0, Velocity = 50.0 };
        var back = new MoveAbsoluteIn { Size = SizeOf<MoveAbsoluteIn>(), Axis = axis, Position = 0.0, Velocity = 25.0 };
        var gone = new MoveAbsoluteOut { Size = SizeOf<MoveAbsoluteOut>() };
        var come = new MoveAbsoluteOut { Size = SizeOf<MoveAbsoluteOut>() };
        var status = new AxisStatus { Size = SizeOf<AxisStatus>() };

        for (long scan = 0; scan < 500; scan++)
        {
            Check(standstill_tick_begin(rt, scan * 1000000), "tick_begin");
            power.Enable = (byte)(scan < 450 ? 1 : 0);
            Check(standstill_mc_power(rt, ref powerKey, ref power, ref powered), "MC_Power");
            there.Execute = powered.Status;
            Check(standstill_mc_move_absolute(rt, ref thereKey, ref there, ref gone), "MC_MoveAbsolute");
            back.Execute = gone.Done;
            Check(standstill_mc_move_absolute(rt, ref backKey, ref back, ref come), "MC_MoveAbsolute");
            Check(standstill_tick_end(rt), "tick_end");
            Check(standstill_axis_read(rt, axis, ref status), "axis_read");
            if (args.Length > 0)
                Console.WriteLine("{0} {1} {2} {3}{4}{5}", Bits(status.Position), Bits(status.Velocity),
                    Bits(status.Acceleration), powered.Status, gone.Done, come.Done);
        }
        Check(standstill_runtime_close(rt), "runtime_close");
        Marshal.FreeHGlobal(memory);
        Console.WriteLine("there and back, and off");
        return 0;
    }
}
