!> The motion of a set at one instant, as the writers take it: that of each of its independent mechanisms, with
!> what is known of it, and where to find the row that a request asks for.
module set_motion
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion, mark_none
   use diagnostics, only: diagnostic_t
   use independent, only: part_t, parts_t, find_parts
   use error_estimate, only: error_estimate_t
   implicit none
   private
   public :: set_motion_t, new_set_motion, is_flagged, has_words, in_set, put_together

   !> `own` is of size 0 where the set is one mechanism; that is the set itself.
   type :: set_motion_t
      type(parts_t) :: parts
      type(mechanism_t), allocatable :: own(:)    !< (parts)
      type(motion_t), allocatable :: motions(:)   !< (parts)
      type(error_estimate_t), allocatable :: kantorovich_ratios(:)   !< (parts)
   end type set_motion_t

contains

   !> The parts of `m`, at rest.
   subroutine new_set_motion(m, s)
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(out) :: s
      integer :: c

      call find_parts(m, s%parts, s%own)
      allocate (s%motions(s%parts%count), s%kantorovich_ratios(s%parts%count))
      if (s%parts%count == 1) s%motions(1) = new_motion(size(m%links))
      do c = 1, size(s%own)
         s%motions(c) = new_motion(size(s%own(c)%links))
      end do
   end subroutine new_set_motion

   !> Some part has not all of its motion.
   pure logical function is_flagged(s)
      type(set_motion_t), intent(in) :: s
      integer :: c

      is_flagged = .true.
      do c = 1, size(s%motions)
         if (s%motions(c)%mark /= mark_none) return
      end do
      is_flagged = .false.
   end function is_flagged

   !> There is something to say of the instant beside its numbers.
   pure logical function has_words(s)
      type(set_motion_t), intent(in) :: s
      integer :: c

      has_words = is_flagged(s)
      do c = 1, size(s%motions)
         has_words = has_words .or. allocated(s%motions(c)%diagnostics)
      end do
   end function has_words

   !> The motion `q` of all links of the set, known as far as that of every part is; places are counted from where each
   !> part counts them.
   subroutine put_together(s, q)
      type(set_motion_t), intent(in) :: s
      type(motion_t), intent(inout) :: q
      integer :: c

      q%t = s%motions(1)%t
      q%known = minval(s%motions%known)
      q%mark = s%motions(minloc(s%motions%known, dim=1))%mark
      if (size(s%own) == 0) then
         q%position = s%motions(1)%position
         q%velocity = s%motions(1)%velocity
         q%acceleration = s%motions(1)%acceleration
      end if
      do c = 1, size(s%own)
         associate (links => s%parts%list(c)%links)
            q%position(:, links) = s%motions(c)%position
            q%velocity(:, links) = s%motions(c)%velocity
            q%acceleration(:, links) = s%motions(c)%acceleration
         end associate
      end do
   end subroutine put_together

   !> The remark `r` of a part in the numbers of the set.
   pure type(diagnostic_t) function in_set(r, part)
      type(diagnostic_t), intent(in) :: r
      type(part_t), intent(in) :: part

      in_set = r
      if (r%pair > 0) in_set%pair = part%pairs(r%pair)
      if (r%drive > 0) in_set%drive = part%drives(r%drive)
      where (r%links > 0) in_set%links = part%links(max(1, r%links))
   end function in_set
end module set_motion
