!> Whether the rows that EXTREMES asks for have turned: between two instants a velocity or an acceleration has changed
!> its sign, or an acceleration has begun to fall or to rise, or its values at five instants are not those of a simple
!> curve. Where nothing of that has happened no number has an extreme, and nothing need be searched for.
module lane_watch
   use kinds, only: wp
   use points, only: row_t
   use zero_search, only: noise_part
   use extremes, only: coordinate_t, alike
   use column_search, only: misses_by, overlooked
   implicit none
   private
   public :: watched_t, look_on, fine_prediction

   !> Steps are short where the prediction from three motions is off by less, in rad or the unit of length: its error is
   !> that of the seventh order.
   real(wp), parameter :: fine_prediction = 1.0e-6_wp

   !> What is known of a coordinate at the last instant: signs are -1, 0 or 1.
   type :: watched_t
      integer :: signs(2) = 0                 !< of velocity and acceleration
      integer :: trend = 0                    !< of the change of the acceleration
      real(wp) :: acceleration = 0.0_wp       !< from which the next change counts
      real(wp) :: differences(0:3) = 0.0_wp   !< of accelerations at the last instants: the value, ...
   end type watched_t

contains

   !> Takes the `rows` of the next instant, of which `list` has the coordinates, and `w` (coordinates) what is known of
   !> them. `steps`: in so many of the last steps one of them may have turned: a sign changes in the last one, an
   !> acceleration that begins to rise may have been at its least before that.
   pure subroutine look_on(w, list, rows, steps)
      type(watched_t), intent(inout) :: w(:)
      type(coordinate_t), intent(in) :: list(:)
      type(row_t), intent(in) :: rows(:)
      integer, intent(out) :: steps
      integer :: i, k, now
      real(wp) :: f(0:2), change

      steps = 0
      do i = 1, size(list)
         f = rows(list(i)%row)%value(list(i)%column, :)
         associate (one => w(i), size_of => list(i)%size_of)
            do k = 1, 2
               now = 0
               if (abs(f(k)) > noise_part*size_of(k)) now = merge(1, -1, f(k) > 0.0_wp)
               if (now /= one%signs(k)) steps = max(1, steps)
               one%signs(k) = now
            end do
            if (.not. is_simple(one%differences, f(2), overlooked*size_of(2))) steps = 2
            call take_difference(f(2), one%differences)
            change = f(2) - one%acceleration
            if (.not. abs(change) > alike*size_of(2)) cycle
            now = merge(1, -1, change > 0.0_wp)
            if (now /= one%trend) steps = 2
            one%trend = now
            one%acceleration = f(2)
         end associate
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
