! Calls the user materials of libtalus_umat.so as their programs do, along a strain path.
!
!   drive INTERFACE NTENS FILE     INTERFACE: umat, user_mod, esm
!
! FILE has: the number of constants and the constants; the stress at the start [units of the host] and the void ratio; the number of
! steps; a line `dt strain(6) rotation(9)` for each, tension-positive, xx yy zz xy yz zx with engineering shear strains, the
! rotation row by row. Prints the stress after every step, xx yy zz xy yz zx, and for umat whether DDSDDE predicts the stress of
! a step that is longer by a thousandth (the largest error over the largest entry of DDSDDE times the change of strain).
program drive
  implicit none
  integer, parameter :: dp = kind(1d0), n_state = 64
  character(80) :: interface_name, text, file_name, cmname
  integer :: ntens, n_constants, n_steps, i, k, n, abort, ns, non_symmetric, on_stress, on_time, tang, ipl
  real(dp) :: props(50), start(6), void_ratio, line(16), stress(6), stress0(6), state(n_state), state0(n_state), dstran(6), drot(3,3)
  real(dp) :: D(6,6), bulk, pore, pore0, unloading, multiplier, additional(20), dtime, strain(12), pnewdt, error, ddsdde(6,6)
  integer, parameter :: order(6) = [1, 2, 3, 4, 6, 5]   ! of umat: 11 22 33 12 13 23
  external :: umat, user_mod, esm

  call get_command_argument(1, interface_name)
  call get_command_argument(2, text)
  read(text, *) ntens
  call get_command_argument(3, file_name)
  open(10, file=file_name, status='old')
  props = 0
  read(10, *) n_constants, props(1:n_constants)
  read(10, *) start, void_ratio
  read(10, *) n_steps
  stress = start
  if (interface_name == 'umat') stress = start(order)
  stress0 = stress
  state0 = 0
  dtime = 0
  state = 0
  state(1) = void_ratio
  bulk = 0; pore0 = 0; additional = 0; pnewdt = 1; D = 0
  cmname = 'SAND'
  n = ntens
  if (interface_name == 'user_mod') then
    call model(4)
    call model(5)
    if (ns < 3 .or. ns > n_state .or. non_symmetric /= 1) stop 3
    call model(1)
  end if
  do k = 1, n_steps
    read(10, *) line
    dtime = line(1)
    dstran = line(2:7)
    drot = transpose(reshape(line(8:16), [3, 3]))
    select case (interface_name)
    case ('umat')
      error = predicted()
      call one_umat(1d0, stress, state, ddsdde, pnewdt)
      if (pnewdt < 1) stop 4
      print '(7(es25.17, 1x))', spread_out(stress), error
    case ('user_mod')
      stress0 = stress
      state0 = state
      strain = 0
      strain(1:6) = dstran
      call model(3)
      call model(6)
      call model(2)
      if (abort /= 0) stop 5
      print '(6(es25.17, 1x))', stress
    case ('esm')
      additional(9) = dtime
      call esm(1, 1, 1, stress, unloading, multiplier, dstran, n_state, state, 20, additional, cmname, n_constants, props, 1, ntens)
      print '(6(es25.17, 1x))', stress
    end select
  end do

contains

  function spread_out(s) result(all)
    real(dp), intent(in) :: s(6)
    real(dp) :: all(6)
    all = 0
    do i = 1, n
      all(order(i)) = s(i)
    end do
  end function

  subroutine one_umat(factor, s, sv, tangent, new_dt)
    real(dp), intent(in) :: factor
    real(dp), intent(inout) :: s(6), sv(n_state), tangent(6,6), new_dt
    real(dp) :: sse, spd, scd, rpl, ddsddt(6), drplde(6), drpldt, stran(6), time(2), predef(1), dpred(1), coords(3)
    real(dp) :: celent, F0(3,3), F1(3,3), de(6), matrix(n,n), sigma(n)
    integer :: jstep(4)
    sse = 0; spd = 0; scd = 0; rpl = 0; drpldt = 0; stran = 0; time = 0; predef = 0; dpred = 0; coords = 0
    celent = 1; F0 = 0; F1 = 0; jstep = 1; matrix = 0
    do i = 1, n
      de(i) = factor * dstran(order(i))
      sigma(i) = s(i)
    end do
    call umat(sigma, sv, matrix, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, de, time, dtime, 0d0, 0d0, predef, dpred, &
              cmname, 3, n - 3, n, n_state, props, n_constants, coords, drot, new_dt, celent, F0, F1, 1, 1, 1, 1, jstep, 1)
    s(1:n) = sigma
    tangent(1:n,1:n) = matrix
  end subroutine

  ! How far DDSDDE is from the change of stress, for a strain that is longer by a thousandth in the same time.
  function predicted() result(error)
    real(dp) :: error, s1(6), s2(6), v1(n_state), v2(n_state), t1(6,6), t2(6,6), w, by(6), change(6)
    w = 1
    s1 = stress; v1 = state
    call one_umat(1d0, s1, v1, t1, w)
    s2 = stress; v2 = state
    call one_umat(1.001d0, s2, v2, t2, w)
    do i = 1, n
      by(i) = 1d-3 * dstran(order(i))
    end do
    change(1:n) = matmul(t1(1:n,1:n), by(1:n))
    error = maxval(abs(s2(1:n) - s1(1:n) - change(1:n))) / max(maxval(abs(t1(1:n,1:n))) * maxval(abs(by(1:n))), 1d-99)
  end function

  subroutine model(task)
    integer, intent(in) :: task
    real(dp) :: sig0(20), sig(20)
    sig0 = 0; sig = 0
    if (task == 1) sig0(1:6) = stress
    if (task /= 1) sig0(1:6) = stress0
    ipl = 0
    if (task == 1) then
      call user_mod(task, 1, 0, 1, 1, 1, 1, 0d0, 0d0, 0d0, 0d0, dtime, props, sig0, pore0, state, strain, D, bulk, sig, pore, &
                    state0, ipl, ns, non_symmetric, on_stress, on_time, tang, 0, 0, abort)
    else
      call user_mod(task, 1, 0, 1, 1, 1, 1, 0d0, 0d0, 0d0, 0d0, dtime, props, sig0, pore0, state0, strain, D, bulk, sig, pore, &
                    state, ipl, ns, non_symmetric, on_stress, on_time, tang, 0, 0, abort)
    end if
    if (abort /= 0) stop 6
    if (task == 2) stress = sig(1:6)
  end subroutine

end program
