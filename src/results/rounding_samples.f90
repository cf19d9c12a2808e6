!> How far a motion is known: the blocks solved again, from the deck as it is and from decks whose numbers are
!> a little off, at instants where digits of the tables could be in doubt.
module rounding_samples
   use kinds, only: wp
   use mechanism, only: mechanism_t, place_links
   use motion, only: motion_t, new_motion, forget_links
   use scales, only: characteristic_length, characteristic_rate
   use convergence, only: convergence_t, is_solved, ended_inconsistent
   use block_solver, only: solve_block
   use engine, only: engine_t
   use block_method, only: block_method_t
   use block_engine, only: block_engine_t, make_block_engine, set_drive_values, get_blocks_motion, know_links
   use perturbed_deck, only: sample_count, perturbed, perturbed_instant
   use error_estimate, only: error_estimate_t, find_estimates, unusable
   implicit none
   private
   public :: samples_t, make_estimates, take_samples

   !> Errors are roundings times |J^-1|^2 times the bend times what is asked for; below this many, and with no number
   !> larger than so many characteristic ones, all digits of a table are safe.
   real(wp), parameter :: safe_growth = 1.0e4_wp, safe_size = 1.0e4_wp
   !> The same by the condition of all closure equations at once, whose pivots are no block's.
   real(wp), parameter :: safe_condition = 1.0e-3_wp

   !> From its own position a search would end at once, and tell nothing of the residual that is left there.
   real(wp), parameter :: nudge = 0.0625_wp*sqrt(epsilon(1.0_wp))

   !> Engines of the deck (0) and of its perturbed kin.
   type :: samples_t
      real(wp) :: length = 1.0_wp, rate = 1.0_wp
      type(block_engine_t), allocatable :: engine(:)
   end type samples_t

contains

   !> Samples of `m`; the engines are made when they are first asked for.
   subroutine make_estimates(s, m)
      type(samples_t), intent(out) :: s
      type(mechanism_t), intent(in) :: m

      s%length = characteristic_length(m)
      s%rate = characteristic_rate(m, s%length)
   end subroutine make_estimates

   !> How far the motion `q` of `m` is known, which the `engine` has found, by a matrix of the reciprocal condition
   !> `rcond`. `always`: also where no digit of a table is in doubt.
   subroutine take_samples(s, m, engine, rcond, q, always, found)
      type(samples_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      class(engine_t), intent(in) :: engine
      real(wp), intent(in) :: rcond
      type(motion_t), intent(in) :: q
      logical, intent(in) :: always
      type(error_estimate_t), intent(inout) :: found

      select type (engine)
      class is (block_method_t)
         call take(s, m, rcond, q, always, found, engine)
      class default
         call take(s, m, rcond, q, always, found)
      end select
   end subroutine take_samples

   !> The same; `e` is present where blocks have found the motion.
   subroutine take(s, m, rcond, q, always, found, e)
      type(samples_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: rcond
      type(motion_t), intent(in) :: q
      logical, intent(in) :: always
      type(error_estimate_t), intent(inout) :: found
      class(block_method_t), intent(in), optional :: e
      integer :: k

      found%taken = .false.
      found%asked = always
      found%in_doubt = is_in_doubt(s, rcond, q, e)
      if (q%known < 0 .or. .not. (always .or. found%in_doubt)) return
      if (.not. allocated(found%samples)) then
         allocate (found%samples(0:sample_count))
         found%samples(:) = new_motion(size(m%links))
      end if
      call make_engines(s, m, q, e)
      if (.not. s%engine(0)%blocks%solvable) return
      do k = 0, sample_count
         associate (u => s%engine(k)%state%u)
            if (present(e)) then
               ! The perturbed deck's unit may be the next power of two.
               call e%copy_values(s%engine(k))
            else
               u%value = s%engine(k)%estimated
            end if
            u(2:)%value = u(2:)%value + nudge
         end associate
         call solve_again(s%engine(k), perturbed_instant(q%t, k), found%samples(k))
      end do
      found%taken = found%samples(0)%known /= unusable .and. any(found%samples(1:)%known /= unusable)
      if (found%taken) call find_estimates(m, s%length, found)
   end subroutine take

   !> Some digit could be in doubt: a pivot is small, or a number large.
   pure logical function is_in_doubt(s, rcond, q, e)
      type(samples_t), intent(in) :: s
      real(wp), intent(in) :: rcond
      type(motion_t), intent(in) :: q
      class(block_method_t), intent(in), optional :: e
      real(wp) :: size_of

      is_in_doubt = .false.
      if (q%known < 2) return
      ! Several ground links that stand far away are rounded as coarsely as far places are.
      size_of = max(largest(q%position, s%length), maxval(abs(q%origin))/s%length, &
         largest(q%velocity, s%length)/s%rate, largest(q%acceleration, s%length)/s%rate**2)
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

   !> The engines of `m`, for the angles and slides of `e`; without it they are those of the position `q`.
   subroutine make_engines(s, m, q, e)
      type(samples_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      class(block_method_t), intent(in), optional :: e
      type(mechanism_t) :: deck
      integer :: k

      if (present(e) .and. allocated(s%engine)) return
      if (allocated(s%engine)) deallocate (s%engine)
      allocate (s%engine(0:sample_count))
      deck = m
      if (.not. present(e)) call place_links(deck, q%position)
      do k = 0, sample_count
         call make_block_engine(s%engine(k), perturbed(deck, k))
      end do
   end subroutine make_engines

   !> The motion of `e` at `t`, from where its unknowns are, to the limit of rounding.
   subroutine solve_again(e, t, q)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: q
      type(convergence_t) :: c
      real(wp) :: correction
      logical :: finite
      integer :: i

      q%t = t
      q%known = 2
      call forget_links(q)
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
      call get_blocks_motion(e, q, finite)
      if (q%known == 0) call know_links(e, q)
   end subroutine solve_again
end module rounding_samples
