!> Tests. The scenes of `make bench`: a deck, its closed forms, and the comparison of the program's methods with them
!> and with each other.
module bench_scenes
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_link, method_newton, method_dense
   use motion, only: motion_t, new_motion, flag_none
   use test_counter, only: sets_of
   use scales, only: characteristic_length, characteristic_rate
   use lapack, only: gesv
   use closure_equations, only: jacobian
   use dense_method, only: dense_t
   use analysis, only: analysis_t, make_analysis, advance
   use plane_vectors, only: degree
   use quad_jet, only: qp
   use closed_forms_dyads, only: body_t, motion_of
   use closed_forms, only: closed_form
   use fast_forms, only: form, fast_four_bar, fast_yoke, fast_andrews, fast_jansen
   use bench_chains, only: link_order_t, new_chain, move_chain, exact_chain
   implicit none
   private
   public :: scene_t, new_scene, chain_scene, move_fast, move_exactly, by_method
   public :: gap_t, error_of, gap_of, widen, instant_of, by_closed_form, steps_of_turn

   !> In the place of a method: the closed form written for speed.
   integer, parameter :: by_closed_form = 0
   !> A turn of the crank or, of a chain, of a rod is this many steps.
   integer, parameter :: steps_of_turn = 3600

   !> A set of computations, and the instants t0 + k step, k = 0, 1, ..., steps, at which it is asked.
   type :: scene_t
      character(:), allocatable :: name
      type(mechanism_t) :: m
      type(link_order_t) :: chain
      procedure(form), pointer, nopass :: fast => null()
      integer :: steps = steps_of_turn
      real(wp) :: t0 = 0.0_wp, step = 12.0_wp/steps_of_turn
      integer :: set = 1
      real(wp) :: length = 1.0_wp, rate = 1.0_wp   !< characteristic
   end type scene_t

   !> Differences of position, velocity, acceleration in the characteristic length and rate.
   type :: gap_t
      real(wp) :: worst(3) = 0.0_wp                !< the largest
      real(wp) :: size(3) = 1.0_wp                 !< the largest values themselves, 1 at least
      real(wp) :: condition = 1.0_wp               !< of all closure equations, the worst on the way
      integer :: instants = 0                      !< compared
      integer :: flagged = 0                        !< not compared: without a result
      logical :: has_change_point = .false.        !< on the way; instants at it are not compared
   end type gap_t

contains

   !> Set `set` of the deck `path`; every link is asked for. `name`: that of its closed form.
   function new_scene(path, name, set) result(s)
      character(*), intent(in) :: path, name
      integer, intent(in) :: set
      type(scene_t) :: s
      type(mechanism_t), allocatable :: sets(:)
      integer :: i

      sets = sets_of(path)
      s%name = name
      s%set = set
      s%m = sets(set)
      s%m%requests = [(request_t(request_link, i, 1), i=1, size(s%m%links))]
      s%length = characteristic_length(s%m)
      s%rate = characteristic_rate(s%m, s%length)
      select case (name)
      case ('four_bar')
         s%fast => fast_four_bar
      case ('yoke')
         s%fast => fast_yoke
      case ('andrews')
         s%fast => fast_andrews
      case ('jansen')
         s%fast => fast_jansen
      end select
   end function new_scene

   !> The chain `kind` with the number `n` of tests/make_deck, its deck in the directory `decks`.
   function chain_scene(decks, kind, n) result(s)
      character(*), intent(in) :: decks, kind
      integer, intent(in) :: n
      type(scene_t) :: s
      character(8) :: number

      write (number, '(i0)') n
      s = new_scene(decks//'/'//kind//'_'//trim(number)//'.deck', kind//' '//trim(number), 1)
      s%chain = new_chain(kind, n)
      s%step = 360.0_wp*degree/steps_of_turn
      s%steps = steps_of_turn/10
   end function chain_scene

   !> The scene's mechanism with another method.
   function by_method(s, method) result(m)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: method
      type(mechanism_t) :: m

      m = s%m
      m%method = method
   end function by_method

   !> The motion at `t` by the closed form written for speed.
   subroutine move_fast(s, t, q)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: q

      if (associated(s%fast)) then
         call s%fast(30.0_wp*degree*t, 30.0_wp*degree, size(q%position, 2), q%position, q%velocity, q%acceleration)
      else
         call move_chain(s%chain, t, q%position, q%velocity, q%acceleration)
      end if
   end subroutine move_fast

   !> The motion at `t` by the closed form in real128, rounded once.
   subroutine move_exactly(s, t, q)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: q
      type(body_t), allocatable :: links(:)
      real(qp) :: motion(3, 0:2)
      integer :: i

      if (s%chain%n > 0) links = exact_chain(s%chain, real(t, qp))
      if (s%chain%n == 0) links = closed_form(s%name, s%set, real(t, qp))
      do i = 1, size(links)
         motion = motion_of(links(i))
         q%position(:, i) = real(motion(:, 0), wp)
         q%velocity(:, i) = real(motion(:, 1), wp)
         q%acceleration(:, i) = real(motion(:, 2), wp)
      end do
   end subroutine move_exactly

   !> Errors of `method`, or of the fast closed form, at `steps`/`every` instants; angles to a whole turn. A method that
   !> has found nothing at the first five of them is given up.
   function error_of(s, method, steps, every) result(g)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: method, steps, every
      type(gap_t) :: g
      type(analysis_t) :: a
      type(motion_t) :: found, exact
      integer :: k

      found = new_motion(size(s%m%links))
      exact = found
      if (method /= by_closed_form) call make_analysis(a, by_method(s, method))
      do k = 0, steps
         if (method /= by_closed_form) call advance(a, instant_of(s, k), found)
         if (mod(k, every) /= 0) cycle
         if (method == by_closed_form) call move_fast(s, instant_of(s, k), found)
         call move_exactly(s, instant_of(s, k), exact)
         if (method == by_closed_form .or. found%flag == flag_none) call widen(s, found, exact, .true., g)
         if (method /= by_closed_form .and. found%flag /= flag_none) g%flagged = g%flagged + 1
         if (g%flagged == 5 .and. g%instants == 0) exit
      end do
   end function error_of

   !> Differences between blocks and dense at the instants 0 to `steps`, angles as they are.
   function gap_of(s, steps) result(g)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: steps
      type(gap_t) :: g
      type(analysis_t) :: blocks, dense
      type(motion_t) :: one, two
      integer :: k

      one = new_motion(size(s%m%links))
      two = one
      call make_analysis(blocks, by_method(s, method_newton))
      call make_analysis(dense, by_method(s, method_dense))
      do k = 0, steps
         call advance(blocks, instant_of(s, k), one)
         call advance(dense, instant_of(s, k), two)
         if (one%flag /= flag_none) g%flagged = g%flagged + 1
         if (two%flag /= flag_none) g%has_change_point = .true.
         if (one%flag /= flag_none .or. two%flag /= flag_none) cycle
         g%condition = max(g%condition, condition_of(dense%dense))
         call widen(s, one, two, .false., g)
      end do
      g%has_change_point = g%has_change_point .or. dense%certificate_counts%passed > 0
   end function gap_of

   !> The condition |A| |A^-1|, in the 1-norm, of all closure equations at the position that `d` has found.
   real(wp) function condition_of(d) result(condition)
      type(dense_t), intent(in) :: d
      real(wp), dimension(d%system%n, d%system%n) :: a, factors, inverse
      integer :: pivots(d%system%n), info, k

      call jacobian(d%system, d%configuration, a)
      factors = a
      inverse = 0.0_wp
      do k = 1, d%system%n
         inverse(k, k) = 1.0_wp
      end do
      call gesv(d%system%n, d%system%n, factors, d%system%n, pivots, inverse, d%system%n, info)
      condition = huge(condition)
      if (info == 0) condition = maxval(sum(abs(a), dim=1))*maxval(sum(abs(inverse), dim=1))
   end function condition_of

   !> Instant number `k`.
   pure real(wp) function instant_of(s, k) result(t)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: k

      t = s%t0 + k*s%step
   end function instant_of

   !> Takes the differences of one instant into `g`.
   subroutine widen(s, one, two, whole_turns, g)
      type(scene_t), intent(in) :: s
      type(motion_t), intent(in) :: one, two
      logical, intent(in) :: whole_turns
      type(gap_t), intent(inout) :: g
      real(wp), parameter :: turn = 360.0_wp*degree
      real(wp) :: d(3, size(one%position, 2))

      g%instants = g%instants + 1
      d = one%position - two%position
      d(:2, :) = d(:2, :) + spread(one%origin - two%origin, 2, size(d, 2))
      if (whole_turns) d(3, :) = d(3, :) - turn*anint(d(3, :)/turn)
      g%worst(1) = max(g%worst(1), largest(s, d))
      g%worst(2) = max(g%worst(2), largest(s, one%velocity - two%velocity)/s%rate)
      g%worst(3) = max(g%worst(3), largest(s, one%acceleration - two%acceleration)/s%rate**2)
      g%size(1) = max(g%size(1), largest(s, two%position))
      g%size(2) = max(g%size(2), largest(s, two%velocity)/s%rate)
      g%size(3) = max(g%size(3), largest(s, two%acceleration)/s%rate**2)
   end subroutine widen

   !> The largest of (3, links), lengths in the characteristic one.
   pure real(wp) function largest(s, d)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: d(:, :)

      largest = max(maxval(abs(d(:2, :)))/s%length, maxval(abs(d(3, :))))
   end function largest
end module bench_scenes
