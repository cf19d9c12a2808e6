!> The error estimate: how far the numbers of a motion are known, from the deck as it is and from perturbed decks, at
!> instants where digits of the tables could be in doubt or where the errors are asked for.
module error_estimate
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_point, request_pole, place_links
   use motion, only: motion_t, new_motion, forget_links
   use points, only: row_t, row_of, difference, is_fixed
   use sum_errors, only: sum_roundings, errors_of_sums, error_of_sums, lost_numbers, growth_in_centres
   use known_digits, only: nothing_known
   use scales, only: characteristic_length, characteristic_rate
   use convergence, only: convergence_t, is_solved, ended_inconsistent
   use block_solver, only: solve_block
   use engine, only: engine_t
   use block_method, only: block_method_t
   use block_engine, only: block_engine_t, make_block_engine, set_drive_values
   use blocks, only: body_vector_t, slide_t, block_loop_t
   use perturbed_deck, only: sample_count, all_samples, perturbation, perturbed, perturbed_instant, round_loops, &
      largest_place
   implicit none
   private
   public :: error_estimate_t, estimator_t, make_estimator, estimate_errors, row_estimate, row_error, largest_errors, &
      is_in_doubt

   !> The perturbed decks differ by an error of as many roundings as the perturbation is long; a number of the deck, and
   !> with it every sum and product, is off by half a rounding. `caution`: for how few the decks are.
   real(wp), parameter :: roundings = perturbation/epsilon(1.0_wp)
   real(wp), parameter :: caution = 2.5_wp

   !> A digit of a table is worth a hundred errors of what the deck leaves open, which is the same for all programs; the
   !> program's own errors may be as large as the digit.
   real(wp), parameter :: own_in_tables = 0.01_wp

   !> Errors are roundings times |J^-1|^2 times the Lipschitz constant of J times what is asked for; below this many
   !> roundings, and with no number larger than so many characteristic ones, all digits of a table are safe.
   real(wp), parameter :: safe_growth = 1.0e4_wp, safe_size = 1.0e4_wp
   !> The same by the reciprocal condition of all closure equations at once, whose pivots are no block's.
   real(wp), parameter :: safe_condition = 1.0e-3_wp

   !> From its own position an iteration would end at once, and show nothing of the residual that is left there.
   real(wp), parameter :: nudge = 0.0625_wp*sqrt(epsilon(1.0_wp))
   !> The deck itself is solved again so many times, each vector of its loops off by a rounding, and not the same way in
   !> every loop. What that changes is the rounding of the calculation: all there is where a result does not depend on
   !> the deck's numbers, as the velocities of links that turn as one. Of 28,000 such motions, up to 3E-5 rad from where
   !> the links are in line, the estimate was below the error in 37.
   integer, parameter :: repeat_count = 4

   !> `known` of a sample that shows nothing: redundant equations contradict one another once each is off by itself.
   integer, parameter :: unusable = -2

   !> Motions at one instant; samples(0) is that of the deck itself, those above are of perturbed decks, those below of
   !> the deck itself with other roundings. They are `taken` where digits of the tables could be `in_doubt`, which are
   !> masked then, or where the errors are `asked` for, if anything moves.
   type :: error_estimate_t
      logical :: taken = .false.             !< `samples` tell something
      logical :: asked = .false.             !< --errors: wanted at every instant
      logical :: in_doubt = .false.          !< digits of this instant may be lost
      !> (length, angle or slide, derivative) The rounding error of a sum of numbers as large as the largest of the
      !> rows.
      real(wp) :: of_sums(3, 0:2) = 0.0_wp
      type(motion_t), allocatable :: samples(:)   !< (-repeat_count:sample_count or all_samples)
   end type error_estimate_t

   !> Engines of the deck (0) and of its perturbed decks, more of them where errors are asked for; the characteristic
   !> length and rate of the mechanism.
   type :: estimator_t
      real(wp) :: length = 1.0_wp, rate = 1.0_wp   !< in the deck's units
      real(wp) :: place = 0.0_wp                   !< the largest number in the place of a point of the ground, likewise
      type(block_engine_t), allocatable :: engine(:)   !< (0:sample_count or all_samples)
   end type estimator_t

contains

   !> Samples of `m`; the engines are made when they are first asked for.
   subroutine make_estimator(s, m)
      type(estimator_t), intent(out) :: s
      type(mechanism_t), intent(in) :: m

      s%length = characteristic_length(m)
      s%rate = characteristic_rate(m, s%length)
      s%place = largest_place(m)
   end subroutine make_estimator

   !> How far the motion `q` of `m` is known, which the `engine` has found, by a matrix of the reciprocal condition
   !> `rcond`. `always`: also where no digit of a table is in doubt.
   subroutine estimate_errors(s, m, engine, rcond, q, always, found)
      type(estimator_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      class(engine_t), intent(in) :: engine
      real(wp), intent(in) :: rcond
      type(motion_t), intent(in) :: q
      logical, intent(in) :: always
      type(error_estimate_t), intent(inout) :: found

      select type (engine)
      class is (block_method_t)
         call take_samples(s, m, rcond, q, always, found, engine)
      class default
         call take_samples(s, m, rcond, q, always, found)
      end select
   end subroutine estimate_errors

   !> The same; `e` is present where blocks have found the motion.
   subroutine take_samples(s, m, rcond, q, always, found, e)
      type(estimator_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: rcond
      type(motion_t), intent(in) :: q
      logical, intent(in) :: always
      type(error_estimate_t), intent(inout) :: found
      class(block_method_t), intent(in), optional :: e
      integer :: k, last

      found%taken = .false.
      found%asked = always
      found%in_doubt = is_in_doubt(s, m, rcond, q, e)
      if (.not. (always .or. found%in_doubt)) return
      if (q%known < 0 .and. .not. allocated(q%link_known)) return
      last = merge(all_samples, sample_count, always)
      if (allocated(found%samples)) then
         if (ubound(found%samples, 1) < last) deallocate (found%samples)
      end if
      if (.not. allocated(found%samples)) then
         allocate (found%samples(-repeat_count:last))
         found%samples(:) = new_motion(size(m%links))
      end if
      call make_engines(s, m, q, last, e)
      if (.not. s%engine(0)%blocks%solvable) return
      do k = -repeat_count, last
         associate (engine => s%engine(max(0, k)))
            if (present(e)) then
               ! The perturbed deck's unit may be the next power of two.
               call e%copy_values(engine)
            else
               engine%state%u%value = engine%estimated
            end if
            engine%state%u(2:)%value = engine%state%u(2:)%value + nudge
            if (k < 0) then
               call solve_rounded(engine, k, s%place, q%t, q%known < 0, found%samples(k))
            else
               call solve_again(engine, perturbed_instant(q%t, k), q%known < 0, found%samples(k))
            end if
         end associate
      end do
      found%taken = found%samples(0)%known /= unusable .and. any(found%samples(1:sample_count)%known /= unusable)
      if (found%taken) found%of_sums = errors_of_sums(m, found%samples(0), s%length)
   end subroutine take_samples

   !> Some digit could be in doubt: a pivot is small, or a number large.
   pure logical function is_in_doubt(s, m, rcond, q, e)
      type(estimator_t), intent(in) :: s
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: rcond
      type(motion_t), intent(in) :: q
      class(block_method_t), intent(in), optional :: e
      real(wp) :: size_of

      is_in_doubt = .false.
      if (q%known < 2) return
      ! Several ground links that stand far away are rounded as coarsely as far places are.
      size_of = max(largest(q%position, s%length), maxval(abs(q%origin))/s%length, &
         largest(q%velocity, s%length)/s%rate, largest(q%acceleration, s%length)/s%rate**2)
      size_of = max(size_of, growth_in_centres(m, q))
      is_in_doubt = size_of > safe_size
      if (is_in_doubt) return
      if (present(e)) then
         is_in_doubt = e%roundings_grow(size_of, safe_growth)
      else
         is_in_doubt = rcond < safe_condition
      end if
   end function is_in_doubt

   !> The largest coordinate, lengths in units of `length`.
   pure real(wp) function largest(x, length)
      real(wp), intent(in) :: x(:, :), length

      largest = max(maxval(abs(x(:2, :)))/length, maxval(abs(x(3, :))))
   end function largest

   !> The engines of `m` and of its perturbed decks up to number `last`, for the angles and slides of `e`; without it
   !> they are those of the position `q`.
   subroutine make_engines(s, m, q, last, e)
      type(estimator_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: last
      class(block_method_t), intent(in), optional :: e
      type(mechanism_t) :: deck
      integer :: k

      if (allocated(s%engine)) then
         if (present(e) .and. ubound(s%engine, 1) >= last) return
         deallocate (s%engine)
      end if
      allocate (s%engine(0:last))
      deck = m
      if (.not. present(e)) call place_links(deck, q%position)
      do k = 0, last
         call make_block_engine(s%engine(k), perturbed(deck, k))
      end do
   end subroutine make_engines

   !> The motion of `e` at `t` with the roundings of sample `k`; `e` keeps its loops. `place`: see `estimator_t`.
   subroutine solve_rounded(e, k, place, t, only_driven, q)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in) :: k
      real(wp), intent(in) :: place, t
      logical, intent(in) :: only_driven
      type(motion_t), intent(inout) :: q
      type(body_vector_t), allocatable :: vectors(:)
      type(slide_t), allocatable :: slides(:)
      type(block_loop_t), allocatable :: loops(:)

      vectors = e%blocks%body_vectors
      slides = e%blocks%slides
      loops = e%blocks%loops
      call round_loops(e%blocks, k, place/e%length)
      call solve_again(e, perturbed_instant(t, k), only_driven, q)
      call move_alloc(vectors, e%blocks%body_vectors)
      call move_alloc(slides, e%blocks%slides)
      call move_alloc(loops, e%blocks%loops)
   end subroutine solve_rounded

   !> The motion of `e` at `t`, from where its unknowns are, to the limit of rounding: of all links, or of those alone
   !> that drives put in their places.
   subroutine solve_again(e, t, only_driven, q)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(in) :: only_driven
      type(motion_t), intent(inout) :: q
      type(convergence_t) :: c
      real(wp) :: correction
      logical :: finite
      integer :: i

      q%t = t
      q%known = 2
      call forget_links(q)
      if (only_driven) then
         q%known = -1
         call e%get_driven_links(t, q)
         return
      end if
      call set_drive_values(e, t)
      correction = 0.0_wp
      do i = 1, size(e%needed)
         c = convergence_t()
         call solve_block(e%blocks, e%needed(i), 0.0_wp, e%work, e%state, c, correction)
         if (c%singular) q%known = 0
         e%is_singular(e%needed(i)) = c%singular
         if (is_solved(c) .and. .not. c%rates_open) cycle
         q%known = merge(unusable, -1, c%ended == ended_inconsistent .or. c%rates_open)
         return
      end do
      call e%get_motion(q, finite)
      if (q%known == 0) call e%get_link_flags(q)
   end subroutine solve_again

   !> What rounding of the deck's numbers leaves open in the row that `request` asks for (3, 0:2), in its units: the
   !> conditioning of the mechanism, whatever program has solved it. `nothing_known`, where it is so. `own`: the part of
   !> this calculation's own roundings that counts.
   pure function row_estimate(m, s, request, own) result(error)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(request_t), intent(in) :: request
      real(wp), intent(in), optional :: own
      real(wp) :: error(3, 0:2), scale(-1:1)
      type(row_t) :: middle, one
      logical :: zero(3, 0:2), lost(3, 0:2)
      integer :: k, last, known

      error = 0.0_wp
      lost = .false.
      if (is_fixed(m, request)) then
         error(:, 0) = fixed_error(m, request)
         return
      end if
      if (s%asked) error = nothing_known
      if (.not. s%taken) return
      error = 0.0_wp
      middle = row_of(m, s%samples(0), request)
      known = middle%known
      zero = abs(middle%value) <= 0.0_wp
      ! Where the Jacobian has no inverse, a position changes with the root of what the deck changes by.
      last = sample_count
      if (present(own) .and. s%asked) last = all_samples
      scale = [own_in_tables, 0.0_wp, 1.0_wp/merge(roundings, sqrt(roundings), known > 0)]
      if (present(own)) scale(-1) = own
      do k = -repeat_count, last
         if (k == 0 .or. s%samples(k)%known == unusable) cycle
         ! Next to a limit of the motion, half of the perturbed decks have no position.
         one = row_of(m, s%samples(k), request)
         if (one%known < 0 .and. known == 0) cycle
         error = max(error, scale(sign(1, k))*difference(one, middle))
         if (request%kind >= request_pole) lost = lost .or. lost_numbers(one, middle)
         zero = zero .and. abs(one%value) <= 0.0_wp
         known = min(known, one%known)
      end do
      ! A coordinate of what stands still is zero without a sum.
      error = merge(0.0_wp, caution*error + error_of_sums(s%of_sums, request, middle), zero)
      if (request%kind < request_pole) error(:, known + 1:) = nothing_known
      error = merge(nothing_known, error, lost)
   end function row_estimate

   !> What rounding leaves open of the place (3) of a ground link or of a point on one: a sum of numbers of cards.
   pure function fixed_error(m, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      real(wp) :: error(3)
      type(row_t) :: row

      row = row_of(m, motion_t(), request)
      error = abs(row%value(:, 0))
      if (request%kind == request_point) then
         associate (p => m%points(request%subject))
            error = max(error, norm2(p%offset), norm2(m%links(p%link)%position(:2)))
         end associate
      end if
      error = merge(sum_roundings*epsilon(1.0_wp)*error, 0.0_wp, abs(row%value(:, 0)) > 0.0_wp)
   end function fixed_error

   !> The estimated error (3, 0:2) of the row of the motion `q`: what rounding leaves open, and how far the row is from
   !> that of the motion solved to the limit of rounding.
   pure function row_error(m, s, q, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      real(wp) :: error(3, 0:2)
      type(row_t) :: row, solved

      error = row_estimate(m, s, request, 1.0_wp)
      if (.not. s%taken .or. is_fixed(m, request)) return
      row = row_of(m, q, request)
      solved = row_of(m, s%samples(0), request)
      where (error < nothing_known) error = error + difference(row, solved)
      if (request%kind >= request_pole) error = merge(nothing_known, error, lost_numbers(row, solved))
   end function row_error

   !> The largest error (0:2) of a position, velocity and acceleration in any row of a link, point or pair;
   !> `nothing_known`, where it is so. In parts of the characteristic `length` and `rate`.
   pure function largest_errors(m, s, q, length, rate) result(largest)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: length, rate
      real(wp) :: largest(0:2), error(3, 0:2), unit(3)
      type(row_t) :: row
      integer :: i, k

      largest = 0.0_wp
      do i = 1, size(m%requests)
         if (m%requests(i)%kind >= request_pole) cycle
         error = row_error(m, s, q, m%requests(i))
         unit = [length, length, 1.0_wp]
         row = row_of(m, q, m%requests(i))
         if (row%angular) unit(1) = 1.0_wp
         do k = 0, 2
            if (any(error(:, k) >= nothing_known)) then
               largest(k) = nothing_known
            else
               largest(k) = max(largest(k), maxval(error(:, k)/(unit*rate**k)))
            end if
         end do
      end do
   end function largest_errors
end module error_estimate
