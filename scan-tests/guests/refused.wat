;; Commands a velocity below 0 with `go`, and reads in the ring of records why the command was refused: `error` is the
;; ErrorID, `asked` the value, the name of the pin is told to the host. 64 .. power key, 72 .. power in, 88 .. power
;; out, 104 .. move key, 112 .. move in, 184 .. move out; 600 number to go on from, 608 records copied, 1024 .. records
(module
  (import "standstill" "mc_power" (func $power (param i32 i32 i32) (result i32)))
  (import "standstill" "mc_move_absolute" (func $move (param i32 i32 i32) (result i32)))
  (import "standstill" "log" (func $log (param i32 i32)))
  (import "standstill" "log_read" (func $log_read (param i32 i32 i32 i32 i32) (result i32)))
  (memory (export "memory") 1)
  (global (export "go") i32 (i32.const 8))
  (global (export "status") i32 (i32.const 92))
  (global (export "refused") i32 (i32.const 616))
  (global (export "error") i32 (i32.const 620))
  (global (export "asked") i32 (i32.const 624))
  (global (export "shown") i32 (i32.const 194))
  (func (export "plc_init")
    (i32.store (i32.const 72) (i32.const 16))
    (i32.store (i32.const 76) (i32.const 1))
    (i32.store (i32.const 80) (i32.const 0x00010101))
    (i32.store (i32.const 88) (i32.const 16))
    (i32.store (i32.const 112) (i32.const 72))
    (i32.store (i32.const 116) (i32.const 1))
    (f64.store (i32.const 128) (f64.const 10))
    (f64.store (i32.const 136) (f64.const -50))
    (i32.store (i32.const 184) (i32.const 16)))
  (func (export "plc_scan") (param $tick i32) (param $now i64) (local $record i32)
    (drop (call $power (i32.const 64) (i32.const 72) (i32.const 88)))
    (i32.store8 (i32.const 120) (i32.and (i32.load8_u (i32.const 8)) (i32.load8_u (i32.const 92))))
    (drop (call $move (i32.const 104) (i32.const 112) (i32.const 184)))
    (drop (call $log_read (i32.const 600) (i32.const 1024) (i32.const 96) (i32.const 8) (i32.const 608)))
    (local.set $record (i32.const 1024))
    (block $end
      (loop $next
        (br_if $end (i32.eqz (i32.load (i32.const 608))))
        (i32.store (i32.const 608) (i32.sub (i32.load (i32.const 608)) (i32.const 1)))
        ;; Refused, and a command of the instance of the move: the low half of its key.
        (if (i32.and
              (i32.eq (i32.load (i32.add (local.get $record) (i32.const 24))) (i32.const 1))
              (i32.eq (i32.load (i32.add (local.get $record) (i32.const 20))) (i32.load (i32.const 104))))
          (then
            (i32.store (i32.const 616) (i32.sub (i32.load (i32.const 616)) (i32.const 1)))
            (i32.store (i32.const 620) (i32.load (i32.add (local.get $record) (i32.const 28))))
            (f64.store (i32.const 624) (f64.load (i32.add (local.get $record) (i32.const 40))))
            (call $log (i32.add (local.get $record) (i32.const 64)) (i32.const 8))))
        (local.set $record (i32.add (local.get $record) (i32.const 96)))
        (br $next)))))
