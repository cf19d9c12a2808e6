!> Whether the rows that EXTREMES asks for have turned: between two instants a velocity or an acceleration has changed
!> its sign, or an acceleration has begun to fall or to rise, or its values at five instants are not those of a simple
!> curve. Where nothing of that has happened no number has an extreme, and nothing need be searched for.
module lane_watch
   use kinds, only: wp
   use points, only: row_t
   use zero_search, only: noise_part
   use extremes, only: extremes_t, alike
   use column_search, only: misses_by, overlooked
   implicit none
   private
   public :: watch_t, new_watch, look_on, fine_prediction

   !> Steps are short where the prediction from three motions is off by less, in rad or the unit of length: its error is
   !> that of the seventh order.
   real(wp), parameter :: fine_prediction = 1.0e-6_wp

   !> What is known of the rows (asked) at the last instant: signs are -1, 0 or 1.
   type :: watch_t
      integer, allocatable :: signs(:, :, :)        !< (3, 2, asked) of velocity and acceleration
      integer, allocatable :: trend(:, :)           !< (3, asked) of the change of the acceleration
      real(wp), allocatable :: acceleration(:, :)   !< (3, asked) from which the next change counts
      real(wp), allocatable :: differences(:, :, :) !< (0:3, 3, asked) of accelerations at the last instants: the value
   end type watch_t

contains

   !> Nothing is known of the rows of `x`.
   function new_watch(x) result(w)
      type(extremes_t), intent(in) :: x
      type(watch_t) :: w

      associate (n => size(x%asked))
         allocate (w%signs(3, 2, n), w%trend(3, n), source=0)
         allocate (w%acceleration(3, n), w%differences(0:3, 3, n), source=0.0_wp)
      end associate
   end function new_watch

   !> Takes the `rows` (asked) of the next instant. `steps`: in so many of the last steps one of them may have turned: a
   !> sign changes in the last one, an acceleration that begins to rise may have been at its least before that.
   pure subroutine look_on(w, x, rows, steps)
      type(watch_t), intent(inout) :: w
      type(extremes_t), intent(in) :: x
      type(row_t), intent(in) :: rows(:)
      integer, intent(out) :: steps
      integer :: q, c, k, now
      real(wp) :: change

      steps = 0
      do q = 1, size(rows)
         do c = 1, x%columns(q)
            do k = 1, 2
               now = 0
               if (abs(rows(q)%value(c, k)) > noise_part*x%size_of(c, k, q)) &
                  now = merge(1, -1, rows(q)%value(c, k) > 0.0_wp)
               if (now /= w%signs(c, k, q)) steps = max(1, steps)
               w%signs(c, k, q) = now
            end do
            if (.not. is_simple(w%differences(:, c, q), rows(q)%value(c, 2), overlooked*x%size_of(c, 2, q))) steps = 2
            call take_difference(rows(q)%value(c, 2), w%differences(:, c, q))
            change = rows(q)%value(c, 2) - w%acceleration(c, q)
            if (.not. abs(change) > alike*x%size_of(c, 2, q)) cycle
            now = merge(1, -1, change > 0.0_wp)
            if (now /= w%trend(c, q)) steps = 2
            w%trend(c, q) = now
            w%acceleration(c, q) = rows(q)%value(c, 2)
         end do
      end do
   end subroutine look_on

   !> The next value `f`, after those with the `differences` (0:3), goes on as a cubic does, but for a part of its last
   !> change; what is less than `open` counts for nothing.
   pure logical function is_simple(differences, f, open)
      real(wp), intent(in) :: differences(0:3), f, open
      real(wp) :: next(0:3)

      next = differences
      call take_difference(f, next)
      is_simple = abs(next(3) - differences(3)) <= misses_by*abs(next(1)) + open
   end function is_simple

   !> Makes the `differences` (0:3) those that end with the value `f`.
   pure subroutine take_difference(f, differences)
      real(wp), intent(in) :: f
      real(wp), intent(inout) :: differences(0:3)
      real(wp) :: before(0:3)
      integer :: k

      before = differences
      differences(0) = f
      do k = 1, 3
         differences(k) = differences(k - 1) - before(k - 1)
      end do
   end subroutine take_difference
end module lane_watch
