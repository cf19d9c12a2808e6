!> Tests. The tables of `make bench` for a step: ratios of what was measured in one repeat, then the middle and the ends
!> of them.
module bench_tables
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, method_matrix, method_dense
   use analysis, only: analysis_t, make_analysis, advance
   use motion, only: motion_t, new_motion
   use study, only: seconds
   use bench_tools, only: spread_t, spread_of, slope, figure
   use bench_chains, only: size_t
   use bench_scenes, only: scene_t, new_scene, chain_scene, gap_t, error_of, by_method, by_closed_form, steps_of_turn, &
      instant_of
   use bench_timing, only: job_t, measure
   implicit none
   private
   public :: steps_table, coarse_table, chains_table, scene_line

   integer, parameter :: repeats = 15
   !> Seconds of one measurement, at least: many clock ticks, yet often less than what another process is given at once.
   real(wp), parameter :: least = 0.003_wp
   real(wp), parameter :: nano = 1.0e9_wp

contains

   !> One turn of four mechanisms in steps of 0.1 deg, by every method.
   subroutine steps_table()
      integer, parameter :: methods(4) = [by_closed_form, method_newton, method_dense, method_matrix]
      character(8), parameter :: decks(4) = [character(8) :: 'four_bar', 'yoke', 'andrews', 'jansen']
      type(scene_t) :: scenes(size(decks))
      type(job_t) :: jobs(size(decks)*size(methods))
      type(gap_t) :: errors(size(jobs))
      real(wp) :: time(size(jobs), repeats)
      integer :: i, k, m

      do i = 1, size(decks)
         scenes(i) = new_scene('input/'//trim(decks(i))//'.deck', trim(decks(i)), 1)
         do m = 1, size(methods)
            k = size(methods)*(i - 1) + m
            jobs(k) = job_t(i, methods(m))
            errors(k) = error_of(scenes(i), methods(m), steps_of_turn, 20)
            if (errors(k)%flagged > 0) jobs(k)%method = by_closed_form
         end do
      end do
      time = measure(scenes, jobs, repeats, least)
      call steps_head()
      do k = 1, size(jobs)
         m = mod(k - 1, size(methods)) + 1
         call print_method(decks(jobs(k)%scene), methods(m), time(k, :), time(k - m + 1, :), errors(k))
      end do
   end subroutine steps_table

   subroutine steps_head()
      print '(a)', '', ' A STEP: POSITION, VELOCITY AND ACCELERATION OF ALL LINKS, 3600 STEPS A TURN', &
         ' RATIO: time over that of the closed form in the same repeat; the middle, the least and the most of 15 repeats', &
         ' BEST: the least time over the least of the closed form, where the machine is busy; NS: the middle time', &
         ' POSITION, VELOCITY, ACCEL.: largest error against the closed form in real128, in the characteristic', &
         ' length and rate; NONE: no result at any of the first steps', '', &
         ' MECHANISM  METHOD        RATIO   LEAST    MOST    BEST      NS  POSITION  VELOCITY    ACCEL.'
   end subroutine steps_head

   subroutine print_method(deck, method, time, closed, e)
      character(*), intent(in) :: deck
      integer, intent(in) :: method
      real(wp), intent(in) :: time(:), closed(:)
      type(gap_t), intent(in) :: e
      character(11), parameter :: names(0:3) = [character(11) :: 'CLOSED FORM', 'BLOCKS', 'MATRIX 1987', 'DENSE']
      type(spread_t) :: ratio, own

      ratio = spread_of(time/closed)
      own = spread_of(time*nano)
      if (e%flagged > 0) then
         print '(1x, a10, 1x, a11, a)', deck//'   ', names(method), '    NONE'
      else
         print '(1x, a10, 1x, a11, 5a8, 3es10.1)', deck//'   ', names(method), figure(ratio%median), &
            figure(ratio%least), &
            figure(ratio%most), figure(own%least/(nano*minval(closed))), figure(own%median), e%worst
      end if
   end subroutine print_method

   !> Three turns of the four-bar and the yoke in coarser steps: the start of a step is no longer right at once.
   subroutine coarse_table()
      integer, parameter :: steps(3) = [steps_of_turn, 360, 36]
      character(8), parameter :: decks(2) = [character(8) :: 'four_bar', 'yoke']
      type(scene_t) :: scenes(size(steps)*size(decks))
      type(job_t) :: jobs(2*size(scenes))
      real(wp) :: time(size(jobs), repeats)
      type(spread_t) :: ratio, own
      integer :: i

      do i = 1, size(scenes)
         associate (deck => decks((i + 2)/3), n => steps(mod(i - 1, 3) + 1))
            scenes(i) = new_scene('input/'//trim(deck)//'.deck', trim(deck), 1)
            scenes(i)%step = 12.0_wp/n
            scenes(i)%steps = 3*n
            ! As by TIME of a deck: beyond its instants the excursions of drives are bounded anew in every step.
            scenes(i)%m%steps = 3*n
            scenes(i)%m%t1 = scenes(i)%m%t0 + 3*n*scenes(i)%step
         end associate
         jobs(2*i - 1:2*i) = [job_t(i, by_closed_form), job_t(i, method_newton)]
      end do
      time = measure(scenes, jobs, repeats, least)
      print '(a)', '', ' COARSE STEPS, BLOCKS: RATIO AND NS AS ABOVE', &
         ' ITERATIONS: a step, of the block that needs most; after a small correction the factors serve again', '', &
         ' MECHANISM  STEPS A TURN   RATIO   LEAST    MOST      NS  ITERATIONS'
      do i = 1, size(scenes)
         ratio = spread_of(time(2*i, :)/time(2*i - 1, :))
         own = spread_of(time(2*i, :)*nano)
         print '(1x, a10, i13, 4a8, f12.2)', scenes(i)%name//repeat(' ', 10), scenes(i)%steps/3, figure(ratio%median), &
            figure(ratio%least), figure(ratio%most), figure(own%median), iterations(scenes(i))
      end do
   end subroutine coarse_table

   !> Iterations a step.
   real(wp) function iterations(s)
      type(scene_t), intent(in) :: s
      type(analysis_t) :: a
      type(motion_t) :: q
      integer :: k

      q = new_motion(size(s%m%links))
      call make_analysis(a, s%m)
      do k = 0, s%steps
         call advance(a, instant_of(s, k), q)
      end do
      iterations = real(a%iterations, wp)/s%steps
   end function iterations

   !> The chains of tests/make_deck in the directory `decks`: closed form, blocks and, where they are small, dense.
   subroutine chains_table(decks)
      character(*), intent(in) :: decks
      type(size_t), parameter :: windows(6) = [size_t('windows', 1), size_t('windows', 10), size_t('windows', 30), &
         size_t('windows', 100), size_t('windows', 1000), size_t('windows', 10000)]
      type(size_t), parameter :: others(2) = [size_t('scissor', 1000), size_t('arm', 1000)]
      type(size_t), parameter :: nets(4) = [size_t('lattice', 3), size_t('lattice', 5), size_t('lattice', 9), &
         size_t('lattice', 15)]
      ! A lattice comes to change points: it is followed for 4 deg.
      integer, parameter :: a_tenth = steps_of_turn/10, four_degrees = steps_of_turn/90
      real(wp) :: time(size(windows), 0:1, repeats)

      print '(a)', '', ' CHAINS: A STEP OF 0.1 DEG, ALL LINKS', &
         ' CLOSED, BLOCKS: ns a step and link, the middle; CLOSED goes link after link (lattice: it is one translation)', &
         ' RATIO: blocks over closed form in the same repeat, middle, least and most; BEST: of the least times', &
         ' DENSE: dense over closed form, the middle', &
         ' READY: ms from the mechanism to the first step; POSITION, ...: errors of the blocks, as above', '', &
         ' CHAIN          LINKS  CLOSED  BLOCKS   RATIO   LEAST    MOST    BEST   DENSE   READY  POSITION  VELOCITY    ACCEL.'
      call chain_rows(decks, windows, a_tenth, repeats, time)
      call print_exponents(real(windows%n, wp), time)
      call chain_rows(decks, others, a_tenth, repeats)
      call chain_rows(decks, nets, four_degrees, repeats)
      ! Seconds a step.
      call chain_rows(decks, [size_t('lattice', 31)], 6, 2)
   end subroutine chains_table

   !> The rows of the chains `sizes`, measured together, `times` times over `steps` steps; `kept`: seconds a step
   !> (sizes, closed form and blocks, times).
   subroutine chain_rows(decks, sizes, steps, times, kept)
      character(*), intent(in) :: decks
      type(size_t), intent(in) :: sizes(:)
      integer, intent(in) :: steps, times
      real(wp), intent(out), optional :: kept(:, 0:, :)
      !> More links would take a second or more a step by all equations at once.
      integer, parameter :: max_links = 70
      type(scene_t) :: scenes(size(sizes))
      type(job_t) :: jobs(3*size(sizes))
      real(wp) :: time(3*size(sizes), times)
      integer :: i, k

      do i = 1, size(sizes)
         scenes(i) = chain_scene(decks, trim(sizes(i)%kind), sizes(i)%n)
         scenes(i)%steps = steps
         jobs(3*i - 2:3*i) = [job_t(i, by_closed_form), job_t(i, method_newton), job_t(i, method_dense)]
         if (size(scenes(i)%m%links) > max_links) jobs(3*i)%method = by_closed_form
      end do
      time = measure(scenes, jobs, times, least)
      do i = 1, size(sizes)
         k = 3*i - 2
         call print_chain(scenes(i), time(k, :), time(k + 1, :), time(k + 2, :), jobs(k + 2)%method == method_dense)
         if (present(kept)) kept(i, :, :) = time(k:k + 1, :)
      end do
   end subroutine chain_rows

   subroutine print_chain(s, closed, blocks, dense, has_dense)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: closed(:), blocks(:), dense(:)
      logical, intent(in) :: has_dense
      type(spread_t) :: c, b, ratio, d
      type(gap_t) :: e
      integer :: n

      n = size(s%m%links)
      c = spread_of(closed*nano/n)
      b = spread_of(blocks*nano/n)
      ratio = spread_of(blocks/closed)
      d = spread_of(dense/closed)
      if (.not. has_dense) d%median = 0.0_wp
      e = error_of(s, method_newton, min(10, s%steps), 1)
      print '(1x, a13, i7, 8a8, 3es10.1)', s%name//repeat(' ', 13), n, figure(c%median), figure(b%median), &
         figure(ratio%median), figure(ratio%least), figure(ratio%most), figure(b%least/c%least), figure(d%median), &
         figure(1000.0_wp*time_ready(by_method(s, method_newton))), e%worst
   end subroutine print_chain

   !> Prints the time of a step of one scene by the closed form and by the blocks, in ns, the least of three, and its
   !> characteristic length and rate. `number`: empty for input/`name`.deck, else that of the chain `name` in `decks`.
   subroutine scene_line(name, number, decks)
      character(*), intent(in) :: name, number, decks
      type(scene_t) :: scene(1)
      type(job_t) :: jobs(2)
      integer :: n

      if (number == '') then
         scene(1) = new_scene('input/'//name//'.deck', name, 1)
      else
         read (number, *) n
         scene(1) = chain_scene(decks, name, n)
      end if
      jobs = [job_t(1, by_closed_form), job_t(1, method_newton)]
      print '(4es24.16)', nano*minval(measure(scene, jobs, 3, least), dim=2), scene%length, scene%rate
   end subroutine scene_line

   !> Seconds from a mechanism to the readiness for its first step.
   real(wp) function time_ready(m) result(time)
      type(mechanism_t), intent(in) :: m
      type(analysis_t) :: a
      real(wp) :: begun, sample(5)
      integer :: i

      do i = 1, size(sample)
         begun = seconds()
         call make_analysis(a, m)
         sample(i) = seconds() - begun
      end do
      time = minval(sample)
   end function time_ready

   !> The exponents of the time a step against the number, from 10 windows on: of each repeat, and of the least times.
   subroutine print_exponents(n, time)
      real(wp), intent(in) :: n(:), time(:, 0:, :)
      real(wp) :: p(0:1, size(time, 3)), best(0:1)
      type(spread_t) :: closed, blocks
      integer :: i, k

      do k = 1, size(time, 3)
         do i = 0, 1
            p(i, k) = slope(pack(n, n >= 10.0_wp), pack(time(:, i, k), n >= 10.0_wp))
         end do
      end do
      closed = spread_of(p(0, :))
      blocks = spread_of(p(1, :))
      do i = 0, 1
         best(i) = slope(pack(n, n >= 10.0_wp), pack(minval(time(:, i, :), dim=2), n >= 10.0_wp))
      end do
      print '(a, 3f6.2, a, f6.3, a, 3f6.2, a, f6.3)', ' windows 10 to 10000 as N**p: blocks', blocks, '  BEST', &
         best(1), &
         ';  closed form', closed, '  BEST', best(0)
   end subroutine print_exponents
end module bench_tables
